"""A solver that is never built ends in a sentence."""

import signal
import time

import pytest

from surrogate.errors import StudyError
from surrogate.solver import Input, Output
from surrogate.study.reading import building
from surrogate.study.study import Study


class NeverBuilt:
    """Waits for ever in its constructor."""

    version, inputs, outputs = "1", {"x": Input(range=(0.0, 1.0))}, {"y": Output()}

    def __init__(self):
        time.sleep(1000)

    def __call__(self, x):
        return {"y": x}


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="needs timers")
def test_building_a_solver_has_a_limit_where_runs_have_one(monkeypatch):
    monkeypatch.setattr(building, "BUILD_SECONDS", 0.05)
    data = {
        "study": "never",
        "solver": f"{__name__}:NeverBuilt",
        "parameters": {"x": [0, 1]},
        "designs": {"train": {"method": "full_factorial"}},
        "execution": {"timeout": 0.05},
    }
    with pytest.raises(StudyError, match="cannot be built: it was not ready after 0.05 s"):
        Study.from_mapping(data)
    assert signal.getitimer(signal.ITIMER_REAL)[0] == 0
