"""What measurements say about inputs: Bayesian calibration by way of a surrogate.

Start from `calibrate.calibrate`; what is asked is a `Problem`, what is found a `Posterior`.
"""
