"""From the scan of a person's leg to the pressure under the bandage on it.

An application on top of the solvers and the study layer; no solver knows it.
"""

from solvers.leg_bandage.person.prediction import Prediction, predict_pressure
from solvers.leg_bandage.person.reduced import Reduced
from solvers.leg_bandage.person.wear import Wear, WearError, wear

__all__ = ["Prediction", "Reduced", "Wear", "WearError", "predict_pressure", "wear"]
