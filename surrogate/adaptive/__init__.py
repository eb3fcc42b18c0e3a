"""Designs whose next points follow from the answers so far.

Start from `choose.choose`. What a point is worth is a plain function in a module of its own:
`expected_improvement`, `contour`, `limit_state`, `variance`, `index_variance`.
"""
