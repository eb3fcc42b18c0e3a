"""Sparse Newton systems: assembled from parts, factored, solved again with kept factors.

Start from `system.System`; a part of the model is a `system.Part`.
"""
