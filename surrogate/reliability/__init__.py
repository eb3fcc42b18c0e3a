"""How probable a failure is: the probability that an output passes a limit.

Start from `answer.reliability`; each method is a file, on a `LimitState`.
"""
