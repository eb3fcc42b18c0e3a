"""Figures, one a file: numbers in, a drawing out."""
