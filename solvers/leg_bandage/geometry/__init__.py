"""Legs: sections, shape modes, bone, and the places that people measure at.

Start from `leg.Leg`; `basis.shipped_basis` gives the modes that ship.
"""
