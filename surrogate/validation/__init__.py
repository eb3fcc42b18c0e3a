"""Surrogates and models beside cases that none has seen, and how well they agree.

Start from `validation.validate`; `agreement` has the figures, `cases.Cases` the cases.
"""
