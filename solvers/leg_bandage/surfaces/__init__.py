"""Smooth surfaces through mesh nodes, and the point of one that lies nearest to a place.

Start from `surfaces.Skin` and `surfaces.Strip`; `projection.project` finds the point.
"""
