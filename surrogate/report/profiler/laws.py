"""Laws of parameters as tables, so that a browser can draw from them."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy import special

from surrogate.space.discrete import DiscreteLaw
from surrogate.space.space import Parameter

#: Normal scores from -REACH to REACH at which quantiles are tabulated. In them the quantiles
#: of smooth laws are smooth, also where the tails are thin.
REACH, NODES = 6.0, 401


def drawn_by(parameter: Parameter) -> dict[str, Any]:
    """The law of the coded value, as `javascript/draws.js` reads it."""
    if parameter.categorical:
        return {"kind": "levels", "count": len(parameter.levels)}
    law = parameter.law
    if isinstance(law, DiscreteLaw):
        return {
            "kind": "steps",
            "values": parameter.encode(law.values).tolist(),
            "up_to": np.cumsum(law.probabilities).tolist(),
        }
    if not parameter.bounded or law.is_uniform:
        return {"kind": "uniform"}
    scores = special.ndtr(np.linspace(-REACH, REACH, NODES))
    return {"kind": "table", "values": parameter.quantile(scores).tolist()}


def told(parameter: Parameter) -> str:
    """The law in words."""
    if parameter.categorical:
        return f"one of {len(parameter.levels)} levels, equally likely"
    return str(parameter.law)
