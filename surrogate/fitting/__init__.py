"""A regressor fitted to one output of the runs, and fitted ones side by side.

Start from `fit.fit`, which gives a `Fit`; `comparison.compare` sets fits side by side.
"""
