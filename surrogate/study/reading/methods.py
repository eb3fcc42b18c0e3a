"""From the words of a study to its surrogates and sensitivity method."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from surrogate.designs.design import Design
from surrogate.errors import FitError, Mistake, PluginError, StudyError, nearest
from surrogate.fitting.fit import minimum_runs
from surrogate.sensitivity import groups as grouping
from surrogate.sensitivity.independence import needs_no_surrogate, spoilt
from surrogate.space.space import Space
from surrogate.stages.fits import Surrogate, learns_from_levels
from surrogate.stages.plugin import call, parameters_of
from surrogate.stages.sensitivity import SensitivityMethod
from surrogate.stages.verified import design_of
from surrogate.study import plugins
from surrogate.study.kinds import check_kind
from surrogate.study.options import option_mistakes
from surrogate.study.parts.methods import SensitivityPart, SurrogatePart
from surrogate.study.reading.mistakes import Reading
from surrogate.study.reading.named import check_surrogate
from surrogate.study.reading.rows import DATA

#: Parameters of plug-ins that the framework fills in; they are not options.
GIVEN_TO_REGRESSORS = ("space", "lower")
GIVEN_TO_SENSITIVITY = ("fit", "space", "confidence", "q2", "groups")


def surrogates_of(
    reading: Reading, designs: Mapping[str, Design], space: Space | None
) -> dict[str, Surrogate]:
    """Unfitted estimators by name, each with its training designs."""
    surrogates = {}
    for name, part in reading.part.surrogates.items():
        found = _surrogate(reading, name, part, designs)
        if found is not None:
            surrogates[name] = found
            _check_training(reading, found, designs)
    if space is not None:
        reading.add(too_small(surrogates.values(), designs, space))
    return surrogates


def _surrogate(
    reading: Reading, name: str, part: SurrogatePart, designs: Mapping[str, Design]
) -> Surrogate | None:
    path = ("surrogates", name)
    with reading.mistakes_at(*path, "method"):
        factory = plugins.load(plugins.REGRESSORS, part.method, reading.folder)
        check_kind(plugins.REGRESSORS, part.method, factory)
        mistakes = option_mistakes(factory, part.options, GIVEN_TO_REGRESSORS)
        reading.add(mistakes, *path, "options")
        if mistakes:
            return None
        estimator = call(f"'{part.method}' cannot be built", factory, **part.options)
        if not (hasattr(estimator, "fit") and hasattr(estimator, "predict")):
            raise StudyError(f"'{part.method}' is not a regressor: it has no fit and predict")
        if estimator.get_params().get("random_state", 0) is None:
            estimator.set_params(random_state=0)
        return Surrogate(name, part.method, estimator, _training(part, designs))
    return None


def _training(part: SurrogatePart, designs: Mapping[str, Design]) -> tuple[str, ...]:
    """The training designs; those that nobody names are `train` and the rows of `data:`."""
    usual = tuple(name for name in ("train", DATA) if name in designs)
    return part.train if "train" in part.model_fields_set or not usual else usual


def _check_training(reading: Reading, surrogate: Surrogate, designs: Mapping[str, Design]) -> None:
    path = ("surrogates", surrogate.name)
    for name in surrogate.train:
        if (
            name not in designs
            and not reading.is_broken("designs", name)
            and name not in reading.part.designs
            and name not in map(design_of, reading.part.solve)
            and not (reading.part.data is not None and name in ("train", DATA))
        ):
            reading.wrong(
                f"trains on design '{name}', which the study does not have; "
                f"{nearest(name, {**designs, **reading.part.designs})}",
                *path,
                "train",
            )
    if learns_from_levels(surrogate.estimator) and not reading.is_broken("levels"):
        trained = [designs[name] for name in surrogate.train if name in designs]
        if not reading.part.levels:
            reading.wrong(
                f"{surrogate.method} learns from levels of fidelity, but the study has no levels:",
                *path,
                "method",
            )
        elif trained and not any(design.levels for design in trained):
            reading.wrong(
                f"{surrogate.method} needs runs of every level; train it on a design of method "
                "nested",
                *path,
                "train",
            )
    if "test" in surrogate.train:
        reading.wrong(
            "design 'test' is held out to test the surrogates; it cannot train them; give the "
            "design another name, or train on others",
            *path,
            "train",
        )


def too_small(
    surrogates: Iterable[Surrogate], designs: Mapping[str, Design], space: Space
) -> Iterator[Mistake]:
    """A mistake for each surrogate with more coefficients than training points."""
    for one in surrogates:
        if any(name not in designs for name in one.train):
            continue
        points = _different([designs[name] for name in one.train])
        try:
            needed = minimum_runs(one.estimator, space)
        except FitError as error:  # its options do not suit the parameters
            yield Mistake(("surrogates", one.name, "options"), str(error))
            continue
        if points < needed:
            yield Mistake(
                ("surrogates", one.name),
                f"{one.method} has {needed} coefficients to find in {space.size} "
                f"parameters, but {', '.join(one.train)} has {points} different "
                "points; use a larger design or a smaller surrogate",
                on_key=True,
            )


def _different(designs: Sequence[Design]) -> int:
    """Number of different points, at most; those that are not searched for yet may differ."""
    leveled = [design.levels for design in designs if design.levels]
    designs = [design for design in designs if not design.levels]
    there = [design.coded for design in designs if design.at_hand]
    sought = sum(one.rows // one.replicates for one in designs if not one.at_hand)
    sought += sum(levels.count(levels[-1]) for levels in leveled)  # only those of the truth
    return sought + (len(np.unique(np.vstack(there), axis=0)) if there else 0)


def sensitivity_of(reading: Reading, space: Space | None) -> SensitivityMethod | None:
    """The sensitivity method with its options."""
    part = reading.part.sensitivity
    if part is None:
        if reading.part.screening is not None and not reading.is_broken("sensitivity"):
            reading.wrong(
                "screening needs sensitivity: {method: sobol}, or shapley", "screening", on_key=True
            )
        return None
    method = _method(part, space)
    _check_reads(reading, part, method)
    with reading.mistakes_at("sensitivity", "method"):
        function = plugins.load(plugins.SENSITIVITY, method, reading.folder)
        reading.add(option_mistakes(function, part.options, GIVEN_TO_SENSITIVITY), "sensitivity")
        if space is not None and spoilt(function, space):
            other = "" if space.constraints else " or dependent_sobol"
            joined, cure = (
                ("joined by constraints", "drop constraints")
                if space.constraints
                else (
                    "correlated",
                    "write correlation: []" if reading.part.data else "drop correlation",
                )
            )
            reading.wrong(
                f"method {part.method} needs independent parameters, but these are "
                f"{joined}; use method shapley{other}, or {cure}",
                "sensitivity",
                "method",
            )
        if reading.part.screening is not None and method not in ("sobol", "shapley"):
            reading.wrong(
                "screening decides by the total indices of method sobol, or by the indices of "
                f"method shapley, not {part.method}; change the method, or drop screening",
                "screening",
                on_key=True,
            )
        _check_groups(reading, method, function, part.groups)
        return SensitivityMethod(
            method, function, part.options, part.surrogate, part.confidence, part.groups
        )
    return None


def _check_reads(reading: Reading, part: SensitivityPart, method: str) -> None:
    """The surrogate that the method reads is there; one that reads runs is given none."""
    function = None
    with suppress(PluginError):  # told when it is loaded for use
        function = plugins.load(plugins.SENSITIVITY, method, reading.folder)
    if not needs_no_surrogate(function):
        needed = "sensitivity reads a surrogate"
        check_surrogate(reading, part.surrogate, needed, "sensitivity", on_key=True)
    elif "surrogate" in part.model_fields_set:
        reading.wrong(
            f"method {method} reads the runs and no surrogate; leave this out",
            "sensitivity",
            "surrogate",
        )


def _method(part: SensitivityPart, space: Space | None) -> str:
    """The method that is asked for; without a word, the one that suits the parameters."""
    dependent = space is not None and not space.independent
    return "shapley" if dependent and "method" not in part.model_fields_set else part.method


def _check_groups(
    reading: Reading, name: str, function: Any, groups: Mapping[str, tuple[str, ...]]
) -> None:
    path = ("sensitivity", "groups")
    if groups and "groups" not in parameters_of(function):
        reading.wrong(
            f"method {name} knows no groups; use method shapley or sobol, or drop them",
            *path,
            on_key=True,
        )
        return
    broken = [str(one[1]) for one in reading.broken if one[0] == "parameters" and len(one) > 1]
    for place, sentence in grouping.mistakes(groups, [*reading.part.parameters, *broken]):
        reading.wrong(sentence, *path, *place, on_key=len(place) == 1)


def check_screening(reading: Reading, outputs: Iterable[str]) -> None:
    """Only outputs of the study can vote."""
    for index, name in enumerate(reading.part.screening.outputs if reading.part.screening else ()):
        if name not in outputs:
            reading.wrong(
                f"the study has no output '{name}'; {nearest(name, outputs)}",
                "screening",
                "outputs",
                index,
            )
