"""From the scan of a person's leg to the pressure under the bandage on it.

An application on top of the solvers and the study layer; no solver knows it.
"""

from .bandage_choice import BandageChoice, BandageChoiceError, choose_bandage
from .hand import PUBLISHED, Hand
from .pressure import Prediction, predict_pressure
from .reduced import Reduced

__all__ = [
    "Hand",
    "PUBLISHED",
    "Prediction",
    "Reduced",
    "BandageChoice",
    "BandageChoiceError",
    "predict_pressure",
    "choose_bandage",
]
