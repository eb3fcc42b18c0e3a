"""Smooth surfaces that contact projects onto, and the point of one nearest to a place.

A surface answers ``at(xi, x)``: for parameters xi (n, 2) and nodal positions x (nodes, 3)
it returns its jet (n, 6, 3): point, d1, d2, d11, d22, d12; and ``stencil(xi)`` tells
which nodes move it and by which weights: nodes (n, k), weights (6, n, k). Rigid surfaces
have k = 0. The normal is d1 x d2, or with `flip` its negative, and must point towards the body
outside.

Start from `skin.Skin`, `strip.Strip` and `rigid.Mandrel`; `projection.project` finds the point.
"""
