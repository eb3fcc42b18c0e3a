"""The word of a study for the best surrogate of each output, whichever the comparison finds."""

BEST = "best"
