"""The option `layers`: several bandages one over the other, with padding beneath them or without.

    layers: [{product: wool}, {product: biflex_16}, {product: biflex_17, direction: reversed}]

The unnumbered inputs are those of the first bandage; `stretch_2`, `overlap_2` ... those of the
second. What a layer states beside product and direction is the nominal value of its input.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from surrogate.errors import StudyError, nearest
from surrogate.solver import Input

from .bandage.fabric import Fabric
from .bandage.products import BANDAGES, INELASTIC, PADS, Bandage, Curve, Pad, at_tension
from .contact.padding import Padding
from .geometry.leg import Leg
from .parameters import INPUTS
from .wrapping.spiral import Wrap, wrap_for

DIRECTIONS = ("onward", "reversed")
"""Round the leg with theta rising, as without the option, or falling."""
OF_EACH = ("tension", "stretch", "overlap", "start_height")
"""Inputs that every bandage has."""
PRODUCTS = {**BANDAGES, **INELASTIC}
MOST = 4
"""Bandages over each other that are taken: as many as kits have."""


@dataclass(frozen=True)
class Layer:
    """One bandage of several: what it is, which way round, and what was stated of it."""

    name: str
    product: Bandage
    direction: str
    stated: Mapping[str, float]


@dataclass(frozen=True)
class Layers:
    """Bandages over each other, the first one first, on padding or on the skin."""

    bandages: tuple[Layer, ...]
    pad: Pad | None = None

    @property
    def inputs(self) -> dict[str, Input]:
        """What the layers add to the inputs of one bandage, and nominal values that they state."""
        own = {name: replace(INPUTS[name], nominal=value) for name, value in self._first()}
        for number, layer in enumerate(self.bandages[1:], start=2):
            product = {"tension": float(layer.product.fabric.tension(np.array(1.3)))}
            for name in OF_EACH:
                nominal = layer.stated.get(name, product.get(name, INPUTS[name].nominal))
                about = f"{INPUTS[name].description}; of bandage {number}, {layer.name}"
                own[f"{name}_{number}"] = replace(INPUTS[name], nominal=nominal, description=about)
        if len(self.bandages) > 1:
            own["wrapping"] = replace(INPUTS["wrapping"], levels=("prescribed",))
        return own | ({} if self.pad is None else _pad_inputs(self.pad))

    def _first(self):
        return self.bandages[0].stated.items()

    @property
    def identity(self) -> list[dict[str, Any]]:
        """What answers hang on besides the inputs: which way round, and fixed constants."""
        return [
            {"direction": layer.direction, **({} if number == 0 else asdict(layer.product))}
            for number, layer in enumerate(self.bandages)
        ]

    def padding(self, leg: Leg, q: Mapping[str, Any], fabric: Fabric) -> Padding | None:
        """The padding, as thick as the first bandage leaves it by Laplace's law; None: without.

        leg      whose mean radius is taken
        fabric   of the first bandage; q the inputs
        """
        if self.pad is None:
            return None
        tension = float(fabric.tension(np.array(q["stretch"])))
        pressure = tension / (1 - q["overlap"]) / _mean_radius(leg)
        return Padding.laid_under(pressure, q["padding_thickness"], q["padding_stiffness"] / 1000)

    def wraps(
        self, leg: Leg, first: Wrap, q: Mapping[str, Any], padding: Padding | None
    ) -> list[Wrap]:
        """How all of them are put on; `first`: the first one as it would be on bare skin."""
        above = 0.0 if padding is None else padding.laid
        wraps = [first]
        for number, layer in enumerate(self.bandages[1:], start=2):
            own = {name: q[f"{name}_{number}"] for name in ("stretch", "overlap", "start_height")}
            thickness = layer.product.fabric.thickness
            wraps.append(
                wrap_for(leg.length, width=layer.product.width, thickness=thickness, **own)
            )
        return [
            replace(wrap, above=above, reversed=layer.direction == "reversed")
            for wrap, layer in zip(wraps, self.bandages, strict=True)
        ]

    def fabrics(self, q: Mapping[str, Any], wrinkled: float, curved: bool) -> list[Fabric]:
        """Fabrics of the second bandage and those after it."""
        found = []
        for number, layer in enumerate(self.bandages[1:], start=2):
            curve: Curve = layer.product.curve if curved or layer.product.curved else ()
            fabric = replace(layer.product.fabric, wrinkled=wrinkled, curve=curve)
            found.append(at_tension(q[f"tension_{number}"], fabric))
        return found


def read_layers(layers: Sequence[Mapping[str, Any]]) -> Layers:
    """The layers of the option; raises StudyError with all that is wrong with them."""
    if not isinstance(layers, Sequence) or isinstance(layers, str) or not layers:
        raise StudyError(f"layers: {layers!r} is no list of layers such as [{{product: wool}}]")
    wrong = [words for number, layer in enumerate(layers) for words in _mistakes(number, layer)]
    if wrong:
        raise StudyError("; ".join(wrong))
    pad = PADS.get(layers[0]["product"])
    bandages = tuple(
        Layer(
            layer["product"],
            PRODUCTS[layer["product"]],
            layer.get("direction", DIRECTIONS[0]),
            {name: float(layer[name]) for name in OF_EACH if name in layer},
        )
        for layer in layers[0 if pad is None else 1 :]
    )
    if not 1 <= len(bandages) <= MOST:
        raise StudyError(f"layers: {len(bandages)} bandages; 1 to {MOST} are taken")
    return Layers(bandages, pad)


def _mistakes(number: int, layer: Any) -> list[str]:
    """What is wrong with one layer."""
    where, keys = f"layers[{number}]", ("product", "direction", *OF_EACH)
    if not isinstance(layer, Mapping):
        return [f"{where}: {layer!r} is no layer such as {{product: biflex_16}}"]
    wrong = [f"{where}: {name!r} is unknown: {nearest(name, keys)}" for name in layer
             if name not in keys]  # fmt: skip
    product, direction = layer.get("product"), layer.get("direction", DIRECTIONS[0])
    if product not in (*PRODUCTS, *PADS):
        wrong.append(f"{where}: product {product!r}: {nearest(str(product), (*PRODUCTS, *PADS))}")
    if product in PADS and number:
        wrong.append(f"{where}: {product} is padding, which lies on the skin: it is layer 0")
    if product in PADS and len(layer) > 1:
        wrong.append(
            f"{where}: padding is stated by the inputs padding_thickness and padding_stiffness"
        )
    if direction not in DIRECTIONS:
        wrong.append(f"{where}: direction {direction!r}: {nearest(str(direction), DIRECTIONS)}")
    for name in OF_EACH:
        low, high = INPUTS[name].range
        value = layer.get(name, low)
        if not isinstance(value, int | float) or not low <= value <= high:
            wrong.append(f"{where}: {name} {value!r} is no number between {low:g} and {high:g}")
    return wrong


def _pad_inputs(pad: Pad) -> dict[str, Input]:
    return {
        "padding_thickness": Input(
            unit="mm",
            nominal=pad.thickness,
            range=(0.5, 20.0),
            description="thickness of all padding without load",
            source=pad.source,
        ),
        "padding_stiffness": Input(
            unit="kPa",
            nominal=pad.stiffness,
            range=(0.05, 20.0),
            description="P0 of the padding: p = P0 ((thickness / present thickness)^3 - 1)",
            source=pad.source,
        ),
    }


def _mean_radius(leg: Leg) -> float:
    """Mean girth between the cuts over 2 pi, mm."""
    return float(leg.girth(np.linspace(0, leg.length, 21)).mean() / (2 * np.pi))
