"""Objects that a notebook shows: a card that stands alone, and a line that says what matters."""

import xml.etree.ElementTree as ET

import pytest

from surrogate import Campaign, Study

STUDY = {
    "study": "shown",
    "about": "Which <of> these & those?",
    "solver": "borehole",
    "parameters": {"rw": [0.05, 0.15], "L": [1120, 1680]},
    "designs": {
        "train": {"method": "latin_hypercube", "runs": 12, "seed": 1},
        "grid": {"method": "full_factorial", "levels": 2, "augment": [{"method": "center_points"}]},
    },
    "surrogates": {"linear": "linear", "gp": "gaussian_process"},
    "sensitivity": {"method": "sobol"},
}


@pytest.fixture(scope="module")
def study():
    return Study.from_mapping(STUDY)


@pytest.fixture(scope="module")
def runs(study, tmp_path_factory):
    return study.run(workers=1, results=tmp_path_factory.mktemp("shown"))


@pytest.fixture(scope="module")
def shown(study, runs, tmp_path_factory):
    told = study.with_surrogates(["linear"])
    with Campaign(told, results=tmp_path_factory.mktemp("campaign")) as campaign:
        campaign.ask(3)
        yield {
            "study": study,
            "space": study.space,
            "design": study.designs["grid"],
            "fit": study.fit(runs)["gp"]["flow"],
            "campaign": campaign,
        }


@pytest.mark.parametrize("name", ["study", "space", "design", "fit", "campaign"])
def test_a_card_is_small_and_complete_in_itself(shown, name):
    """Well-formed, without scripts, links and colours of its own."""
    html = shown[name]._repr_html_()
    ET.fromstring(f"<all>{html}</all>")
    assert len(html) < 6000 and "<script" not in html and "http" not in html
    for colour in ("#", "white", "black"):
        assert colour not in html


def test_lines_say_what_matters(shown):
    fit = shown["fit"]
    assert repr(fit).startswith(f"<Fit gp of flow: Q2 {fit.q2:.4g}, RMSE {fit.rmse:.4g}, runs 12")
    assert repr(shown["campaign"]).startswith(
        "<Campaign shown: points 17, answered 0, handed out 3, left 17"
    )
    assert repr(shown["design"]).startswith("<Design grid: method full_factorial, runs 5")


def test_a_study_tells_its_parts(shown):
    text = repr(shown["study"])
    assert text.splitlines()[0] == "<Study shown>" and len(text) < 800
    for word in ("borehole", "rw, L", "train (12 runs)", "linear, gp", "sobol of best", "flow"):
        assert word in text
    html = shown["study"]._repr_html_()
    assert "Which &lt;of&gt; these &amp; those?" in html and "uniform" in html
