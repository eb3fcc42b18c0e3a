"""From the words of a study to the objects they name; every mistake at once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from surrogate import distributions, plugins, runs, studyfile, units
from surrogate.designs.design import Design
from surrogate.errors import DesignError, PluginError, StudyError, nearest
from surrogate.fitting import minimum_runs
from surrogate.identity import Recipe
from surrogate.plugins import SolverFactory
from surrogate.solver import Input, Solver
from surrogate.source import Source
from surrogate.space import Parameter, Space
from surrogate.studyfile import DesignPart, ParameterPart, StudyPart, SurrogatePart

#: Parameters of plug-ins that the framework fills in; they are not options.
GIVEN_TO_SOLVERS = ("self", "folder")
GIVEN_TO_DESIGNS = ("space", "coded", "folder")
GIVEN_TO_REGRESSORS = ("space",)
GIVEN_TO_SENSITIVITY = ("fit", "space", "confidence")


@dataclass(frozen=True)
class Surrogate:
    """One entry of `surrogates:`: an unfitted estimator and the designs it learns from."""

    name: str
    method: str
    estimator: Any
    train: tuple[str, ...] = ("train",)


@dataclass(frozen=True)
class SensitivityMethod:
    """The entry `sensitivity:`: a function, its options, and the surrogate it reads."""

    name: str
    function: Any
    options: Mapping[str, Any]
    surrogate: str = "best"
    confidence: float = 0.95


@dataclass
class Reading:
    """What has been understood of a study so far, and the mistakes found on the way."""

    part: StudyPart
    folder: Path | None
    broken: set[studyfile.Path]
    mistakes: list[studyfile.Mistake] = field(default_factory=list)

    def wrong(self, sentence: str, *path: str | int, on_key: bool = False) -> None:
        """Note a mistake in the part of the study at `path`."""
        self.mistakes.append(studyfile.Mistake(path, sentence, on_key))

    @contextmanager
    def noting(self, *path: str | int, on_key: bool = False) -> Iterator[None]:
        """Turn errors of the block into mistakes at `path`."""
        try:
            yield
        except StudyError as error:
            for sentence in error.mistakes:
                self.wrong(sentence, *path, on_key=on_key)
        except (PluginError, DesignError) as error:
            self.wrong(str(error), *path, on_key=on_key)

    def options_wrong(self, mistakes: list[tuple[str, str]], *path: str | int) -> None:
        """Note what is wrong with a plug-in's options, which stand at `path`."""
        for option, sentence in mistakes:
            misnamed = not option or "is unknown" in sentence
            self.wrong(sentence, *path, *filter(None, [option]), on_key=misnamed)

    def is_broken(self, *path: str) -> bool:
        """True when the part at `path` was left out because of a mistake of shape."""
        return any(path[:n] in self.broken for n in range(1, len(path) + 1))


def solver_of(reading: Reading) -> tuple[Recipe, Solver | None]:
    """The study's solver, built once here to learn its inputs and outputs."""
    part = reading.part.solver
    factory = SolverFactory(part.name, reading.folder)
    recipe = Recipe(factory.label, factory, part.options)
    if reading.is_broken("solver"):
        return recipe, None
    with reading.noting("solver", "name"):
        mistakes = plugins.option_mistakes(factory.find(), part.options, GIVEN_TO_SOLVERS)
        reading.options_wrong(mistakes, "solver", "options")
        if not mistakes:
            return recipe, _built(recipe, reading)
        # The options that are right may build a solver to check the rest of the study with.
        wrong = {option for option, _ in mistakes}
        sound = {name: value for name, value in part.options.items() if name not in wrong}
        aside = replace(reading, mistakes=[])
        return recipe, _built(replace(recipe, options=sound), aside)
    return recipe, None


def _built(recipe: Recipe, reading: Reading) -> Solver | None:
    with reading.noting("solver", "options"):
        try:
            solver = recipe.solver
        except (StudyError, PluginError):
            raise
        except Exception as error:
            raise PluginError(f"solver '{recipe.name}' cannot be built: "
                              f"{type(error).__name__}: {error}") from error
        if isinstance(solver, Solver):
            return solver
        lacking = [name for name in ("inputs", "outputs", "version") if not hasattr(solver, name)]
        reading.wrong(f"'{recipe.name}' is not a solver: it has no "
                      f"{', '.join(lacking) or '__call__'}", "solver", "name")
    return None


def space_of(reading: Reading, solver: Solver) -> Space | None:
    """Parameters with their ranges in the solver's units, and their correlation."""
    parameters = []
    for name, part in reading.part.parameters.items():
        if name not in solver.inputs:
            reading.wrong(f"the solver has no input '{name}'; {nearest(name, solver.inputs)}",
                          "parameters", name, on_key=True)
            continue
        with reading.noting("parameters", name):
            parameters.append(_parameter(name, part, solver.inputs[name]))
    declared = len(reading.part.parameters)
    if not declared and not reading.is_broken("parameters") and \
            not any(path[0] == "parameters" for path in reading.broken):
        reading.wrong("name at least one parameter that varies", "parameters")
    if len(parameters) < declared or not parameters:
        return None
    with reading.noting("correlation"):
        return Space(tuple(parameters), _correlation(reading, [p.name for p in parameters]))
    return None


def _parameter(name: str, part: ParameterPart, taken: Input) -> Parameter:
    if part.levels or taken.levels:
        return _categorical(name, part, taken)
    unit = taken.unit if part.unit is None else part.unit
    convert = units.conversion(unit, taken.unit)
    kind = part.distribution or "uniform"
    accepted = [*distributions.words_of(kind)[0], *ParameterPart.model_fields]
    mistakes = [f"key '{word}' is unknown here; {nearest(word, accepted)}"
                for word in part.options if word not in accepted]
    mistakes += [f"{word} {value!r}: must be a number" for word, value in part.options.items()
                 if word in accepted and (isinstance(value, bool)
                                          or not isinstance(value, int | float))]
    if part.range is None and part.distribution is None and not mistakes:
        mistakes.append("give a range [smallest, largest] or a distribution")
    if mistakes:
        raise StudyError(*mistakes)
    words = {word: (convert.place if word in distributions.LOCATION_WORDS else
                    convert.distance if word in distributions.SCALE_WORDS else float)(value)
             for word, value in part.options.items()}
    limits = distributions.UNBOUNDED if part.range is None else \
        tuple(convert.place(value) for value in part.range)
    law = distributions.distribution(kind, range=limits, **words)
    _check_accepted(law.support, taken)
    return Parameter(name, law, unit=taken.unit, description=taken.description)


def _check_accepted(support: tuple[float, float], taken: Input) -> None:
    """Refuse a support that reaches beyond what the solver accepts."""
    unit = f" {taken.unit}".rstrip()
    ends = (("smallest", "below", support[0], taken.range[0], support[0] < taken.range[0]),
            ("largest", "above", support[1], taken.range[1], support[1] > taken.range[1]))
    over = [end[:4] for end in ends if end[4]]
    if not all(np.isfinite(value) for _, _, value, _ in over):
        raise StudyError("this distribution goes beyond what the solver accepts "
                         f"({taken.range[0]:g} to {taken.range[1]:g}{unit}); "
                         "add range: [.., ..] to cut it off")
    if over:
        raise StudyError(*(
            f"{value:g}{unit} is {side} the {word} value that the solver accepts "
            f"({limit:g}{unit}); check the value and its unit"
            for word, side, value, limit in dict.fromkeys(over)))


def _categorical(name: str, part: ParameterPart, taken: Input) -> Parameter:
    if not taken.levels:
        raise StudyError(f"levels are for named choices, but the solver takes a number "
                         f"({taken.unit or 'no unit'}) here; give a range")
    if not part.levels:
        raise StudyError(f"the solver takes names here; give levels: [{', '.join(taken.levels)}]")
    unknown = [level for level in part.levels if level not in taken.levels]
    if unknown:
        raise StudyError(*(f"level '{level}' is unknown; {nearest(level, taken.levels)}"
                           for level in unknown))
    return Parameter(name, levels=part.levels, description=taken.description)


def _correlation(reading: Reading, names: list[str]):
    if not reading.part.correlation:
        return None
    matrix = np.eye(len(names))
    for index, (first, second, value) in enumerate(reading.part.correlation):
        unknown = [name for name in (first, second) if name not in names]
        for name in unknown:
            reading.wrong(f"'{name}' is not a parameter of this study; {nearest(name, names)}",
                          "correlation", index)
        if not unknown:
            i, j = names.index(first), names.index(second)
            matrix[i, j] = matrix[j, i] = value
    return tuple(map(tuple, matrix.tolist()))


def constants_of(reading: Reading, solver: Solver) -> dict[str, float | str]:
    """Fixed values of inputs, in the solver's units; nominal values are not repeated here."""
    constants = {}
    for name, part in reading.part.constants.items():
        if name not in solver.inputs:
            reading.wrong(f"the solver has no input '{name}'; {nearest(name, solver.inputs)}",
                          "constants", name, on_key=True)
        elif name in reading.part.parameters:
            reading.wrong(f"'{name}' is also a parameter; it either varies or is fixed",
                          "constants", name, on_key=True)
        else:
            with reading.noting("constants", name):
                constants[name] = _constant(part, solver.inputs[name])
    given = {*reading.part.parameters, *reading.part.constants,
             *(path[1] for path in reading.broken if len(path) > 1)}
    for name, taken in solver.inputs.items():
        if taken.nominal is None and name not in given:
            reading.wrong(f"the solver needs '{name}' and has no nominal value for it; "
                          "add it to parameters or constants", "constants", on_key=True)
    return constants


def _constant(part: studyfile.ConstantPart, taken: Input) -> float | str:
    if taken.levels:
        if part.value not in taken.levels:
            raise StudyError(f"level '{part.value}' is unknown; "
                             f"{nearest(str(part.value), taken.levels)}")
        return part.value
    if isinstance(part.value, str):
        value = units.quantity(part.value, taken.unit)
    else:
        unit = taken.unit if part.unit is None else part.unit
        value = units.conversion(unit, taken.unit).place(part.value)
    _check_accepted((value, value), taken)
    return value


def outputs_of(reading: Reading, solver: Solver, space: Space | None) -> tuple[str, ...]:
    """Names of the outputs that are kept."""
    names = reading.part.outputs or tuple(solver.outputs)
    for index, name in enumerate(names):
        if name not in solver.outputs:
            reading.wrong(f"the solver has no output '{name}'; {nearest(name, solver.outputs)}",
                          "outputs", index)
    kept = {name: solver.outputs[name] for name in names if name in solver.outputs}
    if space is not None:
        for sentence in runs.name_mistakes(space, kept):
            reading.wrong(sentence, "outputs", on_key=True)
    return tuple(kept)


def designs_of(reading: Reading, space: Space | None) -> dict[str, Design]:
    """Coded points of every design, augmentations included.

    Without a space, methods and options are checked all the same.
    """
    designs = {}
    for name, part in reading.part.designs.items():
        design = _design(reading, space, name, part)
        if design is not None:
            designs[name] = design
    if not reading.part.designs and not any(path[0] == "designs" for path in reading.broken):
        reading.wrong("name at least one design, such as train", "designs")
    return designs


def _design(reading: Reading, space: Space | None, name: str, part: DesignPart) -> Design | None:
    path = ("designs", name)
    first = _method(reading, plugins.DESIGNS, part, path)
    more = [_method(reading, plugins.AUGMENTATIONS, addition, (*path, "augment", index))
            for index, addition in enumerate(part.augment)]
    if space is None or first is None or None in more:
        return None
    with reading.noting(*path):
        coded = np.asarray(first(space), dtype=float)
        added = []
        for addition, method in zip(part.augment, more, strict=True):
            rows = method(space, coded)
            added.append((addition.method, len(rows)))
            coded = np.vstack([coded, rows])
        return Design(name, part.method, dict(part.options), coded, tuple(added))
    return None


def _method(reading: Reading, group: str, part, path: studyfile.Path):
    """The plug-in of a design with its options filled in; None when they are wrong."""
    with reading.noting(*path, "method"):
        function = plugins.load(group, part.method, reading.folder)
        mistakes = plugins.option_mistakes(function, part.options, GIVEN_TO_DESIGNS)
        reading.options_wrong(mistakes, *path)
        if mistakes:
            return None
        taken = plugins.parameters_of(function)
        given = {"folder": reading.folder} if "folder" in taken else {}
        if "seed" in taken:
            given["seed"] = part.options.get("seed", 0)
        return partial(function, **{**part.options, **given})
    return None


def surrogates_of(reading: Reading, designs: Mapping[str, Design],
                  space: Space | None) -> dict[str, Surrogate]:
    """Unfitted estimators by name, each with the designs it learns from."""
    surrogates = {}
    for name, part in reading.part.surrogates.items():
        found = _surrogate(reading, name, part)
        if found is not None:
            surrogates[name] = found
            _check_training(reading, found, designs, space)
    return surrogates


def _surrogate(reading: Reading, name: str, part: SurrogatePart) -> Surrogate | None:
    path = ("surrogates", name)
    with reading.noting(*path, "method"):
        factory = plugins.load(plugins.REGRESSORS, part.method, reading.folder)
        mistakes = plugins.option_mistakes(factory, part.options, GIVEN_TO_REGRESSORS)
        reading.options_wrong(mistakes, *path, "options")
        if mistakes:
            return None
        estimator = factory(**part.options)
        if not (hasattr(estimator, "fit") and hasattr(estimator, "predict")):
            raise StudyError(f"'{part.method}' is not a regressor: it has no fit and predict")
        if estimator.get_params().get("random_state", 0) is None:
            estimator.set_params(random_state=0)
        return Surrogate(name, part.method, estimator, part.train)
    return None


def _check_training(reading, surrogate: Surrogate, designs, space: Space) -> None:
    path = ("surrogates", surrogate.name)
    for name in surrogate.train:
        if name not in designs and not reading.is_broken("designs", name) \
                and name not in reading.part.designs:
            reading.wrong(f"learns from design '{name}', which the study has not; "
                          f"{nearest(name, reading.part.designs)}", *path, "train")
    if space is None or any(name not in designs for name in surrogate.train):
        return
    points = np.unique(np.vstack([designs[name].coded for name in surrogate.train]), axis=0)
    needed = minimum_runs(surrogate.estimator, space)
    if len(points) < needed:
        reading.wrong(f"{surrogate.method} has {needed} coefficients to find in {space.size} "
                      f"parameters, but {', '.join(surrogate.train)} has {len(points)} different "
                      "points; use a larger design or a smaller surrogate", *path, on_key=True)


def sensitivity_of(reading: Reading, space: Space | None) -> SensitivityMethod | None:
    """The sensitivity method with its options."""
    part = reading.part.sensitivity
    if part is None:
        if reading.part.screening is not None and not reading.is_broken("sensitivity"):
            reading.wrong("screening needs sensitivity: {method: sobol}", "screening", on_key=True)
        return None
    names = ["best", *reading.part.surrogates]
    if not reading.part.surrogates and not any(p[0] == "surrogates" for p in reading.broken):
        reading.wrong("sensitivity reads a surrogate, but the study has none; add surrogates:",
                      "sensitivity", on_key=True)
    elif part.surrogate not in names and not reading.is_broken("surrogates", part.surrogate):
        reading.wrong(f"surrogate '{part.surrogate}' is unknown; {nearest(part.surrogate, names)}",
                      "sensitivity", "surrogate")
    with reading.noting("sensitivity", "method"):
        function = plugins.load(plugins.SENSITIVITY, part.method, reading.folder)
        reading.options_wrong(plugins.option_mistakes(function, part.options,
                                                      GIVEN_TO_SENSITIVITY), "sensitivity")
        if space is not None and not space.independent \
                and getattr(function, "needs_independent", False):
            reading.wrong(f"method {part.method} needs independent parameters, but these are "
                          "correlated; use method shapley, or drop correlation",
                          "sensitivity", "method")
        if reading.part.screening is not None and part.method != "sobol":
            reading.wrong("screening decides by the total indices of method sobol, not "
                          f"{part.method}; change the method, or drop screening",
                          "screening", on_key=True)
        return SensitivityMethod(part.method, function, part.options,
                                 part.surrogate, part.confidence)
    return None


def sentences(source: Source, mistakes: list[studyfile.Mistake]) -> list[str]:
    """Every mistake as `file:line:column: sentence`, in the order of the file, each once."""
    ordered = sorted(mistakes, key=lambda m: source.locate(m.path, key=m.on_key))
    return list(dict.fromkeys(source.sentence(m.path, m.sentence, key=m.on_key)
                              for m in ordered))
