"""Whether choosing points paid, by the study's own numbers.

For the accuracy over the whole space a space-filling design is hard to beat, and whether choosing
helps depends on the function (Fuhg, Fau and Nackenhorst 2021, doi 10.1007/s11831-020-09474-6). So
each study is asked itself: the error that the learning curve of the initial runs lets expect of as
many runs of their kind, beside the error that was reached, both on the test design.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from surrogate.errors import FitError
from surrogate.fitting.fit import fit, rmse
from surrogate.fitting.learning import learn
from surrogate.fitting.power_law import power_law
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.space.space import Space

Array = NDArray[np.float64]
#: Coded points (m, d) and values (m,).
Runs = tuple[Array, Array]


def gain(space: Space, initial: Runs, whole: Runs, test: Runs, output: str, unit: str) -> str:
    """A sentence: whether choosing the points after the initial ones paid, for one output.

    initial, whole  runs of the design: those before the first choice, and all
    test            runs that judge both
    """
    try:
        fits = [fit(space, *runs, GaussianProcess(), output=output) for runs in (initial, whole)]
        curve = learn(fits[0], GaussianProcess(), test)
        law = power_law(curve.runs, curve.rmse, curve.whole)
    except (FitError, ValueError) as error:
        return f"whether choosing the points paid for {output} cannot be told: {error}"
    if not law.falls:
        return (
            f"whether choosing the points paid for {output} cannot be told: the error of the "
            "initial runs does not surely fall with their number"
        )
    count = len(whole[1])
    expected, low, high = law.at(float(count))
    reached = rmse(test[1], fits[1].predict(test[0]))
    if reached < low:
        verdict = "choosing the points paid"
    elif reached > high:
        verdict = "choosing the points did not pay"
    else:
        verdict = "no gain from choosing the points is to be seen"
    said = f"{reached:.3g} {unit}".rstrip()
    return (
        f"{verdict}: RMSE of {output} on the test design {said} with {count} runs; the learning "
        f"curve of the {curve.whole} initial runs expects {expected:.3g} (90 % interval {low:.3g} "
        f"to {high:.3g}) of as many runs that fill the space"
    )
