"""The geometry of the solver, for the report to show."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from surrogate.errors import SurrogateError
from surrogate.fitting.geometry import Geometry, geometry
from surrogate.scene import Scene
from surrogate.space.space import Space


def scene(
    scene_of: Callable[..., Scene] | None, space: Space, fixed: Mapping[str, Any]
) -> Geometry | str | None:
    """The geometry over the parameters; None for a solver that has none.

    A solver's own mistake costs its geometry only: then a sentence that says what it was.
    """
    if scene_of is None:
        return None
    values = {name: one.value for name, one in fixed.items()}
    try:
        return geometry(scene_of, space, values)
    except SurrogateError as error:
        return f"The geometry is not shown: {error}."
    except Exception as error:  # of the plug-in, whatever it is
        return f"The geometry is not shown: `scene` raised {type(error).__name__}: {error}."
