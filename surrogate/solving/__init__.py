"""Which inputs reach a goal: candidates, and how surely the solver meets the goal there.

Start from `solve.solve`; what is asked is a `Problem`, what is found a `Solution`.
"""
