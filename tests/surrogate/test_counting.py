"""How far a computation is, told from within."""

import time

import numpy as np
import pytest
from sklearn.linear_model import Ridge

from surrogate import counting
from surrogate.counting import counted, listening
from surrogate.fitting.fit import fit
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

SQUARE = Space(tuple(Parameter(name, uniform(-1, 1)) for name in "ab"))


@pytest.fixture
def heard(monkeypatch):
    """All that is told."""
    monkeypatch.setattr(counting, "PAUSE", 0.0)
    return []


def test_loops_in_loops(heard):
    """Both are named, and shares rise evenly to the last part."""
    with listening(heard.append):
        for _ in counted("fold", range(2)):
            for _ in counted("mode", range(4)):
                pass
    assert [part.text for part in heard][:3] == [
        "fold 1 of 2",
        "fold 1 of 2, mode 1 of 4",
        "fold 1 of 2, mode 2 of 4",
    ]
    shares = [part.share for part in heard if "mode" in part.text]
    np.testing.assert_allclose(shares, np.arange(8) / 8)


def test_a_loop_that_an_error_ended_is_forgotten(heard):
    """As a fold that cannot be fitted."""
    with listening(heard.append):
        for k in counted("fold", range(2)):
            modes = counted("mode", range(3))
            next(modes)
            if k:
                modes.close()
    assert [part.text for part in heard][-2:] == ["fold 2 of 2", "fold 2 of 2, mode 1 of 3"]
    assert counting._listener.get() is None


def test_a_field_tells_modes_and_folds(heard):
    """Those of the fit, then those of the fits without each fold."""
    rng = np.random.default_rng(0)
    coded = rng.uniform(-1, 1, (12, 2))
    fields = coded @ rng.standard_normal((2, 9))
    with listening(heard.append):
        fit(SQUARE, coded, fields, Ridge())
    texts = [part.text for part in heard]
    assert {"mode 1 of 2", "mode 2 of 2", "fold 12 of 12, mode 1 of 2"} <= set(texts)
    shares = [part.share for part in heard]
    assert shares == sorted(shares) and shares[0] == 0.0 and 0.9 < shares[-1] < 1.0


def test_telling_costs_next_to_nothing():
    """Less than 10 microseconds a part: 1 % of parts that take a millisecond."""
    count, heard = 20_000, []
    start = time.process_time()
    with listening(heard.append):
        for _ in counted("part", range(count)):
            pass
    assert (time.process_time() - start) / count < 1e-5
