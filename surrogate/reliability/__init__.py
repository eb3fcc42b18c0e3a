"""How probable a failure is: the probability that an output passes a limit.

Start from `analyse.analyse`; each method is a file, on a `LimitState`.
"""
