"""What a prediction tells: figures for scripts, rows for a terminal and a page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from ..bandage.products import STRETCH
from ..scan.summary import figures as scan_figures
from .interval import CONFIDENCE
from .pressure import Prediction
from .summary_points import point_figures
from .worn_pressure import WornPressure

Row = tuple[str, str, str, str]
OWN, MODES = "scan's own sections", "leg of the shape modes"


def figures(told: Prediction) -> dict[str, Any]:
    """Everything but the pressure all over the skin; mmHg, mm, N/mm."""
    fit, solved = told.reduced.at_b1, told.solved
    return {
        "scan": scan_figures(told.scan),
        "bandage": {
            **asdict(told.choice),
            "K1": told.choice.constant,
            "effective_tension": told.choice.effective_tension,
        },
        "pressure_b1": {
            "value": told.value,
            "low": told.low,
            "high": told.high,
            "confidence": CONFIDENCE,
            "on_modes": told.on_modes,
            "shape_factor": told.factor,
            "parts": [asdict(part) for part in told.parts],
        },
        "surrogate": {
            "study": told.reduced.study.name,
            "runs": told.reduced.count,
            "q2": fit.q2,
            "rmse": fit.rmse,
            "inputs": dict(told.inputs),
        },
        "worn": [asdict(one) for one in told.worn()],
        **point_figures(told),
        "extrapolates": told.extrapolates,
        "outside": {
            name: dict(zip(("value", "low", "high"), place, strict=True))
            for name, place in told.outside.items()
        },
        "b1_rules": {name: asdict(one) for name, one in told.rules().items()},
        "laplace": {**told.laplace, "tape": told.tape},
        "solved": None
        if solved is None
        else {"mesh": solved.mesh, "value": solved.value, "seconds": solved.seconds},
        "unsolved": told.unsolved,
        "notes": list(told.notes),
    }


def answers(told: Prediction) -> list[Row]:
    """How, mmHg, 95 % interval, on which leg."""
    beyond = ", EXTRAPOLATED" if told.extrapolates else ""
    corrected = told.factor is not None
    rows = [
        (
            "reduced model",
            f"{told.value:.1f}",
            f"{told.low:.1f} .. {told.high:.1f}",
            (OWN if corrected else MODES) + beyond,
        )
    ]
    if corrected:
        rows.append(("reduced model", f"{told.on_modes:.1f}", "", MODES + beyond))
    if told.solved:
        rows.append(
            (
                f"finite elements, {told.solved.mesh}",
                f"{told.solved.value:.1f}",
                "",
                f"{OWN}; {told.solved.seconds:.0f} s",
            )
        )
    for leg, words in (("scanned", OWN), ("fitted", MODES)):
        rows.append(("Laplace, curvature at B1", _mmhg(told.laplace[leg]), "", words))
    rows.append(("Laplace, tape measure", _mmhg(told.tape), "", OWN))
    return rows


def _mmhg(value: float | None) -> str:
    return "none" if value is None else f"{value:.1f}"


def parts(told: Prediction) -> list[tuple[str, str, str]]:
    """Part of the interval, mmHg either way, what it is."""
    return [(part.name, f"{part.low:+.1f} / {part.high:+.1f}", part.meaning) for part in told.parts]


def worn_rows(worn: Sequence[WornPressure]) -> list[Row]:
    """Posture and time, mmHg, 95 % interval, and how far each part reaches."""
    return [
        (
            one.name,
            f"{one.value:.1f}",
            f"{one.low:.1f} .. {one.high:.1f}",
            "; ".join(f"{part.name} {part.low:+.1f} / {part.high:+.1f}" for part in one.parts),
        )
        for one in worn
    ]


def worn_words(worn: Sequence[WornPressure]) -> list[str]:
    """What the parts are, each once."""
    return list(
        {part.name: f"{part.name}: {part.meaning}" for one in worn for part in one.parts}.values()
    )


def coordinate_rows(told: Prediction) -> list[Row]:
    """Coordinate of the leg, value, range of the runs, inside or OUTSIDE."""
    rows = []
    for name, value in told.inputs.items():
        if name != "leg_length" and not name.startswith("alpha"):
            continue
        low, high = told.reduced.study.space[name].distribution.support
        digits, unit = (1, " mm") if name == "leg_length" else (4, "")
        rows.append(
            (
                name,
                f"{value:.{digits}f}{unit}",
                f"{low:.{max(digits - 1, 1)}f} .. {high:.{max(digits - 1, 1)}f}",
                "OUTSIDE" if name in told.outside else "inside",
            )
        )
    return rows


def choice_words(told: Prediction) -> str:
    """The bandage in a line."""
    choice = told.choice
    words = f"{choice.bandage or 'bandage'} of {choice.tension:.4g} N/mm at stretch {STRETCH:g}"
    if choice.stretch != STRETCH:
        words += f", laid at stretch {choice.stretch:g}: {choice.effective_tension:.4g} N/mm"
    words += f"; two layers; mu_skin {choice.mu_skin:g}"
    if choice.mu_range is not None:
        words += " (not known: {:g} to {:g})".format(*choice.mu_range)
    return words
