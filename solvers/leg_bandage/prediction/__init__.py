"""From the scan of a person's leg to the pressure under the bandage on it.

An application on top of the solvers and the study layer; no solver knows it.
"""

from .bandage_choice import Wear, WearError, wear
from .prediction import Prediction, predict_pressure
from .reduced import Reduced

__all__ = ["Prediction", "Reduced", "Wear", "WearError", "predict_pressure", "wear"]
