"""The dossier: each figure lies where it says, what is missing is named, the page stands alone."""

import json
import re

import pytest

from surrogate import Study
from surrogate.cli.dossier import dossier
from surrogate.errors import StudyError
from surrogate.report import digits
from surrogate.report.dossier import Dossier, Known
from surrogate.runs.dataset import load

STUDY = {
    "study": "evident",
    "about": "How much flows?",
    "solver": "borehole",
    "parameters": {"rw": [0.05, 0.15], "L": [1120, 1680]},
    "designs": {
        "train": {"method": "latin_hypercube", "runs": 12, "seed": 1},
        "test": {"method": "latin_hypercube", "runs": 8, "seed": 2},
    },
    "surrogates": {"linear": "linear", "quadratic": "quadratic"},
    "sensitivity": {"method": "sobol"},
}
TOLD = {
    "question": "Is the flow above 50 m3/year?",
    "context": "A first look | before drilling.",
    "influence": "High: nothing else is known",
    "consequence": "medium: a dry well",
    "code_verification": "It is a formula.",
    "calculation_verification": [{"claim": "digits", "command": "python -V", "result": "<16>"}],
}
HEADINGS = [
    "Question of interest",
    "Context of use",
    "Model risk",
    "Code verification",
    "Calculation verification",
    "Validation",
    "Uncertainty quantification",
    "Applicability",
    "Adequacy",
]


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A folder with a study file, cases and finished runs."""
    folder = tmp_path_factory.mktemp("evident")
    (folder / "cases.csv").write_text("rw,L,flow\n0.1,1400,70\n0.12,1300,110\n0.3,1300,1\n")
    Study.from_mapping(STUDY).run(workers=1, results=folder / "evident")
    return folder


def made(place, **changes):
    """The page of the command, its data, HTML and Markdown."""
    (place / "evident.yaml").write_text(json.dumps({**STUDY, **changes}))
    study = Study.from_yaml(place / "evident.yaml")
    page = dossier(study, place / "evident", place / "evident.yaml")
    html, text = ((place / "evident" / f"dossier.{end}").read_text() for end in ("html", "md"))
    return page, html, text


@pytest.fixture(scope="module")
def whole(place):
    return made(place, credibility=TOLD, validation={"cases": str(place / "cases.csv")})


def test_the_headings_of_the_standard_in_their_order(whole):
    _, html, text = whole
    assert re.findall(r"^## (.+)$", text, re.MULTILINE) == HEADINGS
    assert re.findall(r"<h2[^>]*>(.+?)</h2>", html) == HEADINGS


def test_each_figure_of_the_summary_lies_where_it_says(whole, place):
    """The place leads to the number that is printed."""
    summary = json.loads((place / "evident" / "summary.json").read_text())
    found = 0
    for chapter in whole[0].data["chapters"]:
        for one in chapter["evidence"]:
            match = re.fullmatch(r"summary\.json: ([\w.]+)((?:\[\d+\])+)", one["place"])
            if match is None:
                continue
            value = summary
            for key in match[1].split("."):
                value = value[key]
            for index in re.findall(r"\d+", match[2]):
                value = value[int(index)]
            shown = (
                one["result"]
                .replace(digits.MINUS, "-")
                .split()[0]
                .rstrip("\N{NARROW NO-BREAK SPACE}%")
            )
            assert float(re.match(r"-?[\d.]+", shown)[0]) == pytest.approx(
                100 * value if "%" in one["result"] else value, rel=0.02, abs=5e-3
            ), one
            found += 1
    assert found > 20


def test_every_figure_has_a_command_and_a_place(whole):
    for chapter in whole[0].data["chapters"]:
        for one in chapter["evidence"]:
            assert one["command"] and one["place"] and one["result"], one


def test_units_are_printed_whole(place):
    """A unit with a 1 in it, such as that of a rate, keeps it."""
    runs = load(place / "evident" / "runs.nc")
    runs["flow"].attrs["units"] = "1/s"
    summary = json.loads((place / "evident" / "summary.json").read_text())
    space = Study.from_mapping(STUDY).space
    made = Dossier(Known("evident", "", "evident.yaml", {}, space, runs, summary))
    errors = [one for part in made.chapters for one in part.evidence if "RMSE" in one.claim]
    assert errors
    for one in errors:
        assert one.result.endswith("1/s"), one


def test_what_the_study_tells_is_shown_and_escaped(whole):
    _, html, text = whole
    for word in ("question", "influence", "consequence"):
        assert TOLD[word] in html and TOLD[word] in text
    assert "3 x 2 = 6 of 9" in text and "It is a formula." in text
    assert "&lt;16&gt;" in html and "<16>" not in html
    assert "1 of 3 cases lie outside the ranges" in text
    assert whole[0].data["missing"] == []


def test_the_page_stands_alone(whole):
    """Nothing is loaded, and no credentials or paths of modules are shown."""
    _, html, _ = whole
    assert (
        not re.search(r'(?:src|href)="(?!#|data:)', html) and "http" not in html.split("<body>")[1]
    )


def test_what_is_missing_is_said_with_its_cure(place):
    """Without the section and without cases, each heading that lacks something says so."""
    page, html, text = made(place)
    assert len(page.data["missing"]) == 8
    for word in ("question", "context", "influence", "consequence", "code_verification"):
        assert f"(credibility: {word})" in text and f"(credibility: {word})" in html
    assert "(validation: cases)" in text
    assert any(str(part).startswith("missing: ") for part in page.parts)


def test_computed_cases_are_no_measurements(place):
    """Runs of a solver test the surrogate only; the page says so."""
    other = {**STUDY, "study": "other", "designs": {"train": STUDY["designs"]["test"]}}
    (place / "other.yaml").write_text(json.dumps(other))
    Study.from_yaml(place / "other.yaml").run(workers=1, results=place / "other")
    _, _, text = made(place, validation={"cases": str(place / "other.yaml")})
    assert "The cases are computed, not measured" in text


@pytest.mark.parametrize(
    "wrong, sentence",
    [
        ({"quesion": "x"}, "key 'quesion' is unknown; did you mean 'question'"),
        ({"code_verification": [{"clam": "x"}]}, "key 'clam' is unknown; did you mean 'claim'"),
        ({"code_verification": [{"command": "x"}]}, "key 'claim' is needed here"),
        ({"question": 3}, "must be a text"),
    ],
)
def test_mistakes_have_sentences(wrong, sentence):
    with pytest.raises(StudyError) as caught:
        Study.from_mapping({**STUDY, "credibility": wrong})
    assert any(sentence in one for one in caught.value.mistakes), caught.value.mistakes
