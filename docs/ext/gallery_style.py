"""How the pictures of the gallery look: readable on a phone and in black and white."""

from __future__ import annotations

from typing import Any


def reset(gallery_conf: dict[str, Any], fname: str) -> None:
    """Called by sphinx-gallery before each script."""
    import matplotlib

    matplotlib.rcParams.update(
        {
            "figure.figsize": (7.2, 4.0),
            "figure.dpi": 110,
            "figure.constrained_layout.use": True,
            "axes.spines.top": False,
            "axes.spines.right": False,
            "axes.grid": True,
            "grid.alpha": 0.25,
            "axes.prop_cycle": matplotlib.cycler(
                color=["#1b4965", "#e07a1f", "#5a8f69", "#9b5094"], linestyle=["-", "--", "-.", ":"]
            ),
            "legend.frameon": False,
            "font.size": 10.5,
        }
    )
