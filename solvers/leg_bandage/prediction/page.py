"""The page of `leg-bandage predict --html`: one file that opens offline and loads nothing."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from markupsafe import Markup

from ..scan.page import render
from . import summary, summary_points
from .coloured_leg import (
    BARE,
    BARE_UNDER,
    STOPS,
    Surface,
    pressure_on,
    surface_of,
)
from .pictures import along_drawn, answers_drawn, colour_bar, four_sides
from .pressure import Prediction

TABLE_HEIGHTS = np.arange(0.9, -0.01, -0.1)
TABLE_ANGLES = np.array([180.0, 90.0, 0.0, 270.0])


def person_page(told: Prediction) -> str:
    """Answers, the leg in 3D coloured by pressure, and everything that goes with them."""
    surface = surface_of(told)
    return render(
        __package__,
        "prediction.html",
        told=told,
        choice=summary.choice_words(told),
        answers=summary.answers(told),
        parts=summary.parts(told),
        worn=summary.worn_rows(told.worn()),
        worn_words=summary.worn_words(told.worn()),
        points=summary_points.point_rows(told),
        gradient=summary_points.gradient_words(told),
        along=Markup(along_drawn(told)),
        coordinates=summary.coordinate_rows(told),
        field=_field_words(told),
        height=None if surface.at is None else surface.at[1],
        drawn=Markup(answers_drawn(told)),
        bar=Markup(colour_bar(surface)),
        views=[(side, Markup(view)) for side, view in four_sides(surface)],
        table=_table(told),
        data=Markup(json.dumps(_data(told, surface), separators=(",", ":"))),
    )


def _field_words(told: Prediction) -> str:
    """Where the colours come from, and how far to trust them."""
    if told.solved:
        return f"by the finite element model on mesh {told.solved.mesh}, on the scan's own sections"
    fit = told.reduced.field
    return (
        f"by the reduced model on the leg of the shape modes; it missed left-out runs by "
        f"{fit.rmse:.1f} mmHg (RMS over the skin, edges of the bandage included)"
    )


def _table(told: Prediction) -> list[tuple[str, list[str]]]:
    """Height in mm, and the pressure on the four sides of the leg."""
    values = pressure_on(told.skin(), TABLE_ANGLES, TABLE_HEIGHTS)
    return [
        (f"{height * told.scan.length:.0f}", [f"{value:.0f}" for value in row])
        for height, row in zip(TABLE_HEIGHTS, values, strict=True)
    ]


def _data(told: Prediction, surface: Surface) -> dict[str, Any]:
    """What the drawing on the page is made of; mm and mmHg."""
    middle = surface.points.mean(axis=(0, 1))
    return {
        "points": np.round(surface.points - middle, 1).tolist(),
        "foot": round(float(middle[2]), 1),
        "pressure": np.round(surface.pressure, 1).tolist(),
        "rim": np.round(surface.rim - middle, 1).tolist() if len(surface.rim) else [],
        "value": round(told.solved.value if told.solved else told.value, 1),
        "ticks": surface.ticks.tolist(),
        "stops": STOPS.tolist(),
        "bare": BARE.tolist(),
        "bareUnder": BARE_UNDER,
        "mirrored": surface.mirrored,
    }
