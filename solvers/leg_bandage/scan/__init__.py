"""From the scan of a person's leg to the numbers of the shape basis."""

from solvers.leg_bandage.scan.errors import ScanError
from solvers.leg_bandage.scan.fitting import FittedScan, fit_scan

__all__ = ["FittedScan", "ScanError", "fit_scan"]
