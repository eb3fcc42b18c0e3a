"""From the scan of a person's leg to the numbers of the shape basis."""

from .errors import ScanError
from .fitting import FittedScan, fit_scan

__all__ = ["FittedScan", "ScanError", "fit_scan"]
