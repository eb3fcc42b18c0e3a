"""The profiler in Chromium: its numbers are Python's, and it works by keyboard, small, on paper."""

from __future__ import annotations

import shlex
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import yaml
from made_up import make

from surrogate import report
from surrogate.fitting.fit import Fit
from surrogate.report.profiler.payload import field_stations
from surrogate.space.discrete import integers
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space
from surrogate.study.prediction import fits_at_hand, predict
from surrogate.study.study import Study

STUDIES = Path(__file__).parents[2] / "studies"
SETTLED = "#explore-profiler[data-settled]"
#: Largest difference to Python, as a share of the output's spread.
EQUAL = 1e-9

MIXED = Space(
    (
        Parameter("force", uniform(1.0, 3.0), unit="N"),
        Parameter("cut", distribution("normal", mean=5.0, std=1.0, range=(2.0, 8.0)), unit="kPa"),
        Parameter("teeth", integers((3, 9))),
        Parameter("cloth", levels=("p", "q", "r")),
    ),
    ((1.0, 0.6, 0.0, 0.0), (0.6, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0)),
)


@dataclass
class Explored:
    """A report, the space of its parameters, and the fits that its profiler should show."""

    path: Path
    space: Space
    fits: dict[str, Fit]


@pytest.fixture(scope="session")
def explored(
    report_of: Callable[[str], Path], tmp_path_factory: pytest.TempPathFactory
) -> Callable[[str], Explored]:
    """Reports by name: those of studies, and `mixed` inputs joined by a copula."""

    @cache
    def of(name: str) -> Explored:
        if name == "mixed":
            content = make(MIXED, outputs=("pressure_b1", "slope"), sensitivity=False)
            path = report.build(content).save(tmp_path_factory.mktemp("mixed") / "report.html")
            fits = {o: content.fits[content.best(o)][o] for o in content.outputs}
            return Explored(path, MIXED, fits)
        path, shipped = report_of(name), STUDIES / f"{name}.yaml"
        study = Study.from_yaml(shipped if shipped.exists() else path.with_name("study.yaml"))
        found, _ = fits_at_hand(study, path.parent, None)
        return Explored(path, study.space, {output: fit for output, (_, fit) in found.items()})

    return of


def shown(page):
    """Values of the parameters, and mean, low and high of the outputs, as the page holds them."""
    page.wait_for_selector(SETTLED)
    return page.evaluate(
        """() => ({
          values: [...document.querySelectorAll(".control")].map((one) => one.dataset.value),
          outputs: Object.fromEntries([...document.querySelectorAll(".answer")].map((one) =>
            [one.dataset.output, {...one.dataset, words: one.querySelector(".value").dataset.number,
              place: [...one.querySelectorAll("select")].map((s) => s.selectedIndex)}])),
        })"""
    )


def coded_of(space, values):
    columns = {
        p.name: np.array([value if p.categorical else float(value)])
        for p, value in zip(space.parameters, values, strict=True)
    }
    return space.encode(columns)


def compare(explored, found):
    """Shown and held numbers of all outputs with Python's at the same point."""
    coded = coded_of(explored.space, found["values"])
    assert set(found["outputs"]) == set(explored.fits)
    for name, fit in explored.fits.items():
        told, shape = found["outputs"][name], fit.values.shape[1:]
        place = tuple(at[k] for at, k in zip(field_stations(shape), told["place"], strict=True))
        at = (0, *place)
        scale = fit.values[(slice(None), *place)].std()
        low, high = (end[at] for end in fit.interval(coded))
        mean = fit.predict(coded)[at]
        for key, own in {"mean": mean, "low": low, "high": high}.items():
            assert abs(float(told[key]) - own) <= EQUAL * scale, (name, key)
        words = told["words"].replace("\N{MINUS SIGN}", "-")
        decimals = len(words.partition(".")[2])
        assert abs(float(words) - mean) <= 0.5000001 * 10.0**-decimals


@pytest.mark.parametrize(
    "name",
    ["bandage_laplace", "bandage_shorter", "mixed"]
    + [pytest.param("bandage_surrogates", marks=pytest.mark.slow)],
)
def test_every_slider_shows_pythons_numbers(name, explored, open_page):
    """Each parameter is moved, by keyboard, and the page is compared after each move."""
    one = explored(name)
    opened = open_page(one.path)
    page = opened.page
    before = shown(page)
    compare(one, before)
    for parameter in one.space.parameters:
        control = page.locator(f'.control[data-parameter="{parameter.name}"]')
        if parameter.categorical:
            control.locator("select").select_option(parameter.levels[-1])
        else:
            control.locator("input[type=range]").press("PageUp")
            control.locator("input[type=range]").press("ArrowRight")
        after = shown(page)
        moved = [a != b for a, b in zip(before["values"], after["values"], strict=True)]
        assert moved == [other is parameter for other in one.space.parameters]
        compare(one, after)
        before = after
    assert opened.said == [] and opened.asked == [one.path.as_uri()]


def test_places_of_a_field_are_chosen(explored, open_page):
    """Another place of the pressure field, with its own interval."""
    one = explored("bandage_shorter")
    page = open_page(one.path).page
    shown(page)
    for k, choice in enumerate(page.locator(".answer .place select").all()):
        choice.select_option(index=2 + k)
    found = shown(page)
    assert found["outputs"]["pressure_field"]["place"] == [2, 3]
    compare(one, found)


def test_typed_values_and_extrapolation(explored, open_page):
    """A value outside of the range is taken and said to extrapolate; nonsense is not taken."""
    one = explored("mixed")
    page = open_page(one.path).page
    shown(page)
    field = page.get_by_label("force, value")
    field.fill("3.5")
    field.press("Enter")
    found = shown(page)
    compare(one, found)
    from playwright.sync_api import expect  # the folder is skipped where it is not installed

    where = page.locator(".where")
    expect(where).to_contain_text("Extrapolation: force is outside of its range, 1")
    field.fill("much")
    field.press("Enter")
    assert shown(page)["values"] == found["values"]
    teeth = page.get_by_label("teeth, value")
    teeth.fill("7.4")
    teeth.press("Enter")
    assert shown(page)["values"][2] == "7"
    page.get_by_role("button", name="Back to the start").click()
    expect(where).to_contain_text("Inside")


def test_copied_command_gives_the_shown_numbers(explored, open_page):
    """`surrogate predict` with the copied words, and constants that YAML reads back."""
    one = explored("bandage_laplace")
    page = open_page(one.path).page
    page.locator('.control[data-parameter="alpha1"] input[type=range]').press("PageDown")
    found = shown(page)
    page.get_by_role("button", name="Copy as command").click()
    command = shlex.split(page.get_by_label("Copied").input_value())
    assert command[:3] == ["surrogate", "predict", "bandage_laplace.yaml"]
    study = Study.from_yaml(STUDIES / "bandage_laplace.yaml")
    (row,) = predict(study, one.path.parent, None, command[3:], None).rows
    for name, told in row["outputs"].items():
        scale = one.fits[name].values.std()
        for key, own in {"mean": "value", "low": "low", "high": "high"}.items():
            assert abs(float(found["outputs"][name][key]) - told[own]) <= EQUAL * scale
    page.get_by_role("button", name="Copy as YAML").click()
    constants = yaml.safe_load(page.get_by_label("Copied").input_value())["constants"]
    assert list(constants) == list(one.space.names)
    assert [str(value) for value in constants.values()] == found["values"]


def test_target_search_moves_the_sliders(explored, open_page, tmp_path):
    """A pressure is reached with one parameter held; Python agrees at the point found.

    The goals that are copied are those of a study file.
    """
    one = explored("bandage_laplace")
    opened = open_page(one.path)
    page = opened.page
    start = shown(page)
    page.locator('.control[data-parameter="leg_length"] .hold input').check()
    page.get_by_role("tab", name="Target search").click()
    row = page.locator('.goals tr[data-output="pressure_b1"]')
    row.get_by_label("goal of pressure_b1").select_option("target")
    for label, value in {"not below": "30", "target": "34", "not above": "35"}.items():
        row.get_by_label(label).fill(value)
    page.get_by_role("button", name="Search").click()
    page.wait_for_selector(".found[data-merit]")
    assert float(page.locator(".found").get_attribute("data-merit")) == pytest.approx(1, abs=1e-6)
    found = shown(page)
    compare(one, found)
    assert float(found["outputs"]["pressure_b1"]["mean"]) == pytest.approx(34.0, abs=1e-5)
    assert found["values"][2] == start["values"][2] and found["values"] != start["values"]
    radius = page.locator('.goals tr[data-output="curvature_radius"]')
    radius.get_by_label("goal of curvature_radius").select_option("limits")
    radius.get_by_label("from").fill("40")
    radius.get_by_label("to").fill("")
    page.get_by_role("button", name="Copy as YAML").click()
    fragment = page.get_by_label("Copied").input_value()
    copied = (
        STUDIES.joinpath("bandage_laplace.yaml").read_text() + fragment[fragment.index("solve:") :]
    )
    (tmp_path / "goals.yaml").write_text(copied)
    assert yaml.safe_load(copied)["solve"]["explored"] == {
        "desirability": {"pressure_b1": {"target": [30, 34, 35]}},
        "subject_to": ["curvature_radius >= 40 mm"],
        "fix": {"leg_length": float(start["values"][2])},
    }
    assert "explored" in Study.from_yaml(tmp_path / "goals.yaml").problems
    assert opened.said == []


def test_monte_carlo_has_the_moments_of_the_closed_form(explored, open_page):
    """100 000 draws of two Gaussian processes, against their exact means and variances."""
    one = explored("bandage_laplace")
    opened = open_page(one.path)
    opened.page.get_by_role("tab", name="Monte Carlo").click()
    opened.page.wait_for_selector(".chances[data-settled]")
    for name, fit in one.fits.items():
        card = opened.page.locator(f'.card[data-output="{name}"]')
        mean, deviation = (
            float(card.get_attribute(f"data-{key}")) for key in ("mean", "deviation")
        )
        exact = fit.estimator.sobol_indices()
        assert abs(mean - exact.mean) <= 4.0 * np.sqrt(exact.variance / 1e5)
        assert deviation**2 == pytest.approx(exact.variance, rel=4.0 * np.sqrt(3.0 / 1e5))
    assert opened.said == []


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_small_screens_and_paper(scheme, explored, open_page):
    """At 390 px nothing is wider than the page; on paper stands the profile, without controls."""
    one = explored("mixed")
    opened = open_page(one.path, width=390, height=844, color_scheme=scheme)
    page = opened.page
    shown(page)
    for name in ("Contour", "Target search", "Monte Carlo"):
        page.get_by_role("tab", name=name).click()
        if name == "Target search":
            page.get_by_label("goal of slope").select_option("minimise")
            page.get_by_role("button", name="Search").click()
            page.wait_for_selector(".found[data-merit]")
        assert page.evaluate("document.documentElement.scrollWidth") <= 390
    page.emulate_media(media="print")
    assert page.locator(".matrix").is_visible()
    assert not page.locator(".profiler .tabs").is_visible()
    assert page.locator(".profiler input:visible, .profiler button:visible").count() == 0
    assert opened.said == []


def test_keyboard_alone(explored, open_page):
    """Every control has a name and a focus; tabs follow the arrows; sliders say their value."""
    page = open_page(explored("mixed").path).page
    shown(page)
    nameless = page.evaluate(
        """() => [...document.querySelectorAll(".profiler :is(input, select, button, textarea)")]
          .filter((one) => !one.labels?.length && !one.getAttribute("aria-label"))
          .filter((one) => !one.textContent.trim()).length"""
    )
    assert nameless == 0
    slider = page.locator('.control[data-parameter="teeth"] input[type=range]')
    slider.focus()
    page.keyboard.press("Home")
    page.keyboard.press("ArrowRight")
    assert shown(page)["values"][2] == "4"
    assert slider.get_attribute("aria-valuetext") == "4"
    page.get_by_role("tab", name="Contour").focus()
    page.keyboard.press("ArrowRight")
    assert page.get_by_role("tab", name="Target search").get_attribute("aria-selected") == "true"
    assert page.locator(".answer .value").first.get_attribute("aria-live") == "polite"


def test_engine_without_a_worker(explored, open_page):
    """Where no worker is to be had, the page works things out itself, and says the same."""
    one = explored("mixed")
    opened = open_page(one.path)
    opened.page.add_init_script("delete window.Worker")
    opened.page.reload()
    compare(one, shown(opened.page))
    assert opened.said == []
