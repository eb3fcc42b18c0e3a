"""Designs whose next points follow from the answers so far.

Start from `choose.choose`. What a point is worth is a plain function in a module of its own:
`expected_improvement`, `contour`, `expected_feasibility`, `variance`, `index_variance`.
"""
