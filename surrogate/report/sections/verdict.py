"""The verdict on one output: how good, what matters, what may be frozen."""

from __future__ import annotations

import re

import numpy as np
from sklearn.pipeline import Pipeline

from surrogate.fitting.fit import Fit
from surrogate.report import digits
from surrogate.report.blocks import Figure, Verdict, anchor
from surrogate.report.content import POOR_Q2, Content
from surrogate.report.figures.candidates import candidates_plot
from surrogate.report.figures.freezing import freezing_plot
from surrogate.report.figures.parity import parity_plot
from surrogate.report.figures.responses import response_plot
from surrogate.report.figures.sobol import SHARE, Bars, index_bars
from surrogate.report.parity import parity
from surrogate.report.sections import leading
from surrogate.report.sections.accuracy import TEST, held_out
from surrogate.report.sections.indices import STAMP, of_output, refusal
from surrogate.report.sections.measures import index, measures_of, names_of, unit_of
from surrogate.report.sections.screening import may_be_frozen
from surrogate.report.sections.solve import goal
from surrogate.sensitivity.importance import TOTAL
from surrogate.solving.solution import chance

#: Errors below this share of the output's spread are rounding.
ROUNDING = 1e-9
#: Height of the three drawings where their rows allow it.
HEIGHT = 310.0
#: Names of frozen inputs in the sentence; all outputs of the study have a say in them.
FROZEN = 6
#: What the shipped surrogates are; others are called by their class.
KINDS = {
    "Linear": "linear model",
    "Interactions": "linear model with interactions",
    "Quadratic": "quadratic model",
    "Stepwise": "stepwise polynomial",
    "Lasso": "LASSO polynomial",
    "PolynomialChaos": "polynomial chaos expansion",
    "Huber": "robust polynomial",
    "MixedModel": "mixed model",
    "CoKriging": "co-kriging",
}


def verdict(content: Content, output: str) -> Verdict:
    """One output: a sentence and up to three figures."""
    best = content.best(output)
    clauses = [
        _predicted(content, output, best),
        leading.clause(content, output),
        *([] if content.screening is None else [may_be_frozen(content.screening, FROZEN)]),
    ]
    figures = [
        figure
        for figure in (
            _how_good(content, output, best),
            _what_matters(content, output),
            _which_inputs(content, output)
            or _what_may_be_frozen(content, output)
            or _how_it_responds(content, output, best),
        )
        if figure is not None
    ]
    q2 = content.q2(best, output) if best else np.nan
    error = content.rmse(best, output) if best else np.nan
    return Verdict(
        output,
        anchor("output", output),
        f"{'; '.join(clause for clause in clauses if clause)}.",
        meaning=_meaning(content, output),
        surrogate=best or digits.NOTHING,
        q2=digits.score(q2),
        error=digits.with_unit(digits.figure(error, 2), content.unit(output)),
        poor=bool(q2 < POOR_Q2),
        matters=leading.words(content, output),
        shares=leading.shares(content, output),
        figures=tuple(figures),
    )


def called(fit: Fit) -> str:
    """What a surrogate is, and its name in the study: `the Gaussian process gp`."""
    estimator = fit.estimator
    if isinstance(estimator, Pipeline):
        estimator = estimator[-1]
    kind = type(getattr(estimator, "estimator", estimator)).__name__
    words = KINDS.get(kind) or re.sub(r"(?<=[a-z])(?=[A-Z])", " ", kind).capitalize()
    plain = fit.surrogate.replace("_", " ").lower()
    return f"the {words}" if plain in words.lower() else f"the {words} {fit.surrogate}"


def _meaning(content: Content, output: str) -> str:
    """What the solver says of an output, when that is more than its name."""
    words = str(content.runs[output].attrs.get("long_name", "")).rstrip(".")
    return "" if words.replace("_", " ").lower() == output.replace("_", " ").lower() else words


def _predicted(content: Content, output: str, best: str | None) -> str:
    """How well the best surrogate predicts the output."""
    if best is None:
        return (
            "no surrogate could be fitted"
            if content.fits
            else f"{digits.quantity(int(content.finished(output).sum()), 'finished run')}"
        )
    name, error = called(content.fits_of(output)[best]), content.rmse(best, output)
    count = digits.quantity(held_out(content, output), "held-out run")
    kind = f"on {count}" if content.tested(best, output) else "in cross-validation"
    if not np.isfinite(error):
        return (
            f"the error of {name} on new points is not known, for there are no held-out runs and "
            "no run can be left out of the training design"
        )
    if error <= ROUNDING * _spread(content, output):
        solver = "table" if content.recorded else "solver"
        return f"{name} is exact to rounding {kind}: the {solver} itself has this form"
    within = digits.with_unit(digits.figure(error, 2), content.unit(output))
    return (
        f"{name} predicts it within {within} (RMSE {kind}; "
        f"Q²\N{NO-BREAK SPACE}{digits.score(content.q2(best, output))})"
    )


def _spread(content: Content, output: str) -> float:
    values = content.values(output)[content.finished(output)]
    return float(np.sqrt(np.mean(np.var(values, axis=0)))) if len(values) > 1 else 0.0


def _how_good(content: Content, output: str, best: str | None) -> Figure | None:
    """Held-out runs where there are some, otherwise training runs by cross-validation."""
    if best is None:
        return None
    data = parity(content, content.fits_of(output)[best], output)
    if data.run.size == 0:
        return None
    held = ~data.learnt
    if TEST in content.designs:
        held &= np.isin(data.run, content.numbers[content.words("design") == TEST])
    data = data.only(held) if held.any() else data
    bars = f" Bars: 95{digits.THIN}% prediction intervals." if np.isfinite(data.half).any() else ""
    kind = (
        digits.quantity(int(held.sum()), "held-out run")
        if held.any()
        else f"{digits.quantity(len(data.run), 'training run')}, by cross-validation"
        if data.honest
        else f"{digits.quantity(len(data.run), 'training run')}, as fitted"
    )
    what = "Means of the field. " if content.is_field(output) else ""
    return Figure(
        parity_plot(data, output, content.unit(output), best, height=HEIGHT),
        f"{what}{best} on {kind}. Dashed: equality.{bars}",
        question="How good is it?",
    )


def _what_matters(content: Content, output: str) -> Figure | None:
    """The leading index of each input, with its interval."""
    table = of_output(content, output)
    if table is None:
        return None
    refused = refusal(content, output)
    names = names_of(table)
    if "first_order" in table and "total" in table:
        shown = {"first_order": "first order", "total": "total"}
    else:
        first = next(iter(measures_of(table)), "")
        if not first:
            return None
        shown = {first: leading.SHARES.get(first, first)}
    series = [
        Bars(
            "dark" if k == 0 else "light",
            title,
            *(index(table, name)[part] for part in ("value", "low", "high")),
        )
        for k, (name, title) in enumerate(shown.items())
    ]
    shares = {"first_order", *leading.SHARES} >= set(shown)
    unit = unit_of(next(iter(shown)), table, content.unit(output))
    label = SHARE if shares else digits.labelled(next(iter(shown)), unit)
    confidence = digits.percent(float(table.attrs.get("confidence", 0.95)))
    what = (
        "Sobol' indices. Filled: first order; outlined: total."
        if len(shown) == 2
        else f"{next(iter(shown.values()))}."
    )
    what = digits.capital(what)
    bars = f" Whiskers: {confidence} intervals." if np.isfinite(series[-1].low).any() else ""
    return Figure(
        index_bars(
            names, series, label, f"What matters for {output}", trusted=not refused, height=HEIGHT
        ),
        f"{what}{bars}",
        stamp=STAMP if refused else "",
        question="What matters?",
    )


def _which_inputs(content: Content, output: str) -> Figure | None:
    """The candidates of the first goal that names the output; nothing without one."""
    found = {name: one for name, one in content.solve.items() if output in one.surrogates}
    if not found:
        return None
    name, solution = next(iter(found.items()))
    return Figure(
        candidates_plot(
            content.space, solution.candidates, f"Inputs that reach {name}", height=HEIGHT
        ),
        f"{goal(solution)} Filled: the best candidate, met with "
        f"{chance(solution.candidates[0].probability)}; open: the others.",
        question="Which inputs reach the goal?",
    )


def _what_may_be_frozen(content: Content, output: str) -> Figure | None:
    """The index that decides, against the limit; nothing without a screening."""
    decision, table = content.screening, of_output(content, output)
    if decision is None or table is None or output not in decision.outputs:
        return None
    own = "total_high" in table
    values = {v.parameter: v for v in decision.verdicts}
    names = names_of(table)
    found = (
        index(table, "total")
        if own
        else {
            "value": np.array([values[name].total for name in names]),
            "low": np.full(len(names), np.nan),
            "high": np.array([values[name].high for name in names]),
        }
    )
    elsewhere = [
        name
        for name, high in zip(names, found["high"], strict=True)
        if high < decision.freeze_below and name not in decision.freeze
    ]
    reason = (
        f" {digits.listing(elsewhere)} {'is' if len(elsewhere) == 1 else 'are'} kept because of "
        "another output."
        if elsewhere and len(decision.outputs) > 1
        else ""
    )
    what = TOTAL if own else "index that decides"
    return Figure(
        freezing_plot(
            names,
            found,
            decision.freeze,
            decision.freeze_below,
            f"What may be frozen for {output}",
            trusted=not decision.refused,
            height=HEIGHT,
        ),
        f"{digits.capital(what)} with its {digits.percent(decision.confidence)} interval. "
        f"Dashed: limit {digits.number(decision.freeze_below)}. Open: may be frozen.{reason}",
        stamp=STAMP if decision.refused else "",
        question="What may be frozen?",
    )


def _how_it_responds(content: Content, output: str, best: str | None) -> Figure | None:
    """The best surrogate along the leading inputs."""
    if best is None:
        return None
    found = leading.leading(content, output)
    names = list(content.space.names) if found is None else found.names
    if all(content.space[name].categorical for name in names):
        return None
    what = f"mean {output}" if content.is_field(output) else output
    return Figure(
        response_plot(
            content.fits_of(output)[best], content.space, names, content.unit(output), what
        ),
        f"{best} along the leading inputs, the others in the middle of their ranges.",
        question="Which way does it go?",
    )
