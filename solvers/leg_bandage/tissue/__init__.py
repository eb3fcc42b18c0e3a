"""Soft tissue between skin and bone: its mesh and its nearly incompressible law.

Start from `neo_hooke.Tissue`; `mesh.leg_mesh` makes the hexahedra.
"""
