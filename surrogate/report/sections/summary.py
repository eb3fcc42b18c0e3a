"""The question, the answers and the warnings."""

from __future__ import annotations

import numpy as np
import xarray as xr

from surrogate.report import digits
from surrogate.report.blocks import Block, Fact, Facts, Points, Section, Text
from surrogate.report.content import POOR_Q2, Content
from surrogate.report.parity import learnt_only_from
from surrogate.report.sections import groups, screening
from surrogate.report.sections.accuracy import held_out, runner_up
from surrogate.report.sections.designs import roman
from surrogate.report.sections.indices import DECIMALS, of_output, refusal
from surrogate.report.sections.measures import index, measures_of, method_of, names_of, unit_of
from surrogate.report.sections.validation import verdicts
from surrogate.sensitivity.screening import Screening

#: Names written out in a sentence.
MOST = 8
#: Errors below this share of the output's spread are rounding.
ROUNDING = 1e-9
#: Share of held-out runs inside their 95 % intervals below which the intervals are too narrow.
POOR_COVERAGE = 0.8


def section(content: Content) -> Section:
    """The question, an answer for each output, the decision, the warnings."""
    blocks: list[Block] = []
    if content.about:
        blocks.append(Text(content.about, "lead"))
    blocks.append(Facts(tuple(_facts(content))))
    if not content.fits:
        blocks.append(Text("The study asks for no surrogate; the report shows its runs.", "note"))
    warned = warnings(content)
    if warned:
        blocks.append(Points(tuple(warned), "warning"))
    else:
        blocks.append(
            Text(
                "No warnings: no failed run, no poor surrogate, no refused index.",
                "good",
            )
        )
    return Section("answer", "Question and answer", tuple(blocks))


def _facts(content: Content) -> list[Fact]:
    facts = [_asked(content)]
    several = len(content.outputs) > 1
    for output in content.outputs:
        suffix = f" of {output}" if several else ""
        best, table = content.best(output), of_output(content, output)
        if best is not None:
            facts.append(_best(content, best, output, suffix))
        if table is not None:
            facts += [_matters(content, table, output), *_groups(content, table, output, suffix)]
    if content.validation is not None:
        facts += [
            Fact("Closest model in validation" + (f": {output}" if several else ""), *words)
            for output, *words in verdicts(content.validation)
        ]
    if content.screening is not None:
        facts.append(_frozen(content.screening))
    return facts


def _asked(content: Content) -> Fact:
    solver = str(content.runs.attrs.get("solver", ""))
    outputs = digits.listing(content.outputs) or "no output"
    many = digits.quantity(content.space.size, "parameter")
    of = f" of {'table' if content.recorded else 'solver'} {solver}" if solver else ""
    failed = int(content.failed.sum())
    runs = digits.quantity(len(content.ok), "run") + (f", {failed} failed" if failed else "")
    return Fact(
        "What was asked",
        f"{outputs} over {many}",
        f"{digits.listing(content.space.names, MOST)}{of}; {runs}.",
    )


def _best(content: Content, best: str, output: str, suffix: str) -> Fact:
    row = content.row(best, output)
    unit = content.unit(output)
    held = np.isfinite(row.get("q2_test", np.nan))
    how = "test" if held else "cv"
    error = row.get(f"rmse_{how}", np.nan)
    count = digits.quantity(held_out(content, output), "held-out run")
    kind = f"on {count}" if held else "in cross-validation"
    if not np.isfinite(error):
        return Fact(
            f"Best surrogate{suffix}",
            best,
            "Its error on new points is not known: there are no held-out runs, and no run can be "
            "left out of the training design.",
        )
    spread = _spread(content, output)
    if error <= ROUNDING * spread:
        return Fact(
            f"Best surrogate{suffix}",
            f"{best}, exact to rounding",
            f"It reproduces the solver {kind}: the solver itself has this form.",
        )
    words = f"Q² {digits.score(row.get(f'q2_{how}', np.nan))} {kind}"
    if spread > 0:
        scatter = digits.with_unit(digits.figure(spread), unit)
        words += f"; the output has a standard deviation of {scatter}"
    return Fact(
        f"Best surrogate{suffix}",
        f"{best}, RMSE {digits.with_unit(digits.figure(error, 2), unit)}",
        f"{words}. {runner_up(content, output)}".rstrip(),
    )


def _spread(content: Content, output: str) -> float:
    values = content.values(output)[content.finished(output)]
    return float(np.sqrt(np.mean(np.var(values, axis=0)))) if len(values) > 1 else 0.0


def _matters(content: Content, table: xr.Dataset, output: str) -> Fact:
    title = "What matters most" + (f" to {output}" if len(content.outputs) > 1 else "")
    refused = refusal(content, output)
    if refused:
        return Fact(title, "not answered", refused)
    leading = "total" if "total" in table else next(iter(measures_of(table)), "")
    if not leading:
        return Fact(title, "not known", method_of(table))
    names, total = names_of(table), index(table, leading)
    order = np.argsort(-np.nan_to_num(np.abs(total["value"]), nan=-1.0))
    shares = [
        digits.with_interval(*(total[part][k] for part in ("value", "low", "high")), most=DECIMALS)
        for k in order[:3]
    ]
    words = [f"{names[k]} {share}" for k, share in zip(order[:3], shares, strict=True)]
    what = _titled(leading, unit_of(leading, table, content.unit(output)))
    return Fact(title, names[order[0]], f"{what}, largest first: {'; '.join(words)}.")


def _titled(measure: str, unit: str) -> str:
    """What a measure is called where a sentence begins."""
    known = {"total": "Total indices", "shapley": "Shapley effects"}
    return known.get(measure, digits.labelled(measure, unit) if unit else measure)


def _groups(content: Content, table: xr.Dataset, output: str, suffix: str) -> list[Fact]:
    if "group" not in table.dims or refusal(content, output):
        return []
    return [Fact(f"Which group explains most of the variance{suffix}", *groups.answer(table))]


def _frozen(decision: Screening) -> Fact:
    title = "What may be frozen"
    if decision.refused:
        return Fact(title, "not answered", screening.sentence(decision))
    kept = [
        f"{screening.share_kept(kept)} of the variance"
        + (f" of {kept.output}" if len(decision.variance_kept) > 1 else "")
        for kept in decision.variance_kept
    ]
    if not decision.freeze:
        return Fact(title, "nothing", screening.sentence(decision))
    few = len(decision.freeze) <= MOST // 2
    of = f"{len(decision.freeze)} of {digits.quantity(len(decision.verdicts), 'parameter')}"
    names = "" if few else f"{digits.listing(decision.freeze, MOST)}. "
    return Fact(
        title,
        digits.listing(decision.freeze) if few else of,
        f"{names}The other parameters explain {digits.listing(kept)}.",
    )


def warnings(content: Content) -> list[str]:
    """What a reader must know before using a figure, a sentence each."""
    said = []
    failed = int(content.failed.sum())
    if failed:
        of = digits.quantity(len(content.ok), "run")
        said.append(f"{failed} of {of} failed and are not used for training; see Runs.")
        said += [content.failing] if content.failing else []
    missing = int(content.missing.sum())
    if missing:
        said.append(
            f"{digits.quantity(missing, 'run')} of the designs "
            f"{'is' if missing == 1 else 'are'} not done yet."
        )
    said += content.not_done
    said += [words for name in content.outputs if (words := uneven(content, name))]
    for output in content.outputs:
        said += [*_poor(content, output), *_saturated(content, output)]
        said += [words] if (words := refusal(content, output)) else []
    for design, aliasing in content.aliasing.items():
        names = learnt_only_from(content, design)
        if aliasing.resolution == 3 and names:
            said.append(
                f"Design {design}, the training design of "
                f"{'surrogate' if len(names) == 1 else 'surrogates'} {digits.listing(names)}, has "
                f"resolution {roman(3)}: main effects are aliased with two-factor interactions."
            )
    return said


def uneven(content: Content, output: str) -> str:
    """A sentence when the scatter of replicates depends on the place; "" otherwise."""
    scatter = content.replicates.get(output)
    if scatter is None or not scatter.uneven:
        return ""
    low, high = (digits.figure(std, 2) for std in (scatter.smallest, scatter.largest))
    unit = content.unit(output)
    return (
        f"The scatter of {output} depends on the place: its replicates have standard deviations "
        f"from {low} to {digits.with_unit(high, unit)} (Brown-Forsythe test, "
        f"p = {digits.figure(scatter.p, 2)}). The intervals, which take it to be the same "
        "everywhere, are too wide at some places and too narrow at others."
    )


def _poor(content: Content, output: str) -> list[str]:
    best = content.best(output)
    if best is None:
        return [f"No surrogate of {output} could be fitted."] if content.fits else []
    said, q2 = [], content.q2(best, output)
    if np.isfinite(q2) and q2 < POOR_Q2:
        said.append(
            f"The best surrogate of {output}, {best}, has a Q² of only {digits.fixed(q2, 2)}, "
            f"below {POOR_Q2:g}: its predictions are rough."
        )
    coverage = content.row(best, output).get("coverage_95", np.nan)
    if coverage < POOR_COVERAGE:
        said.append(
            f"The 95{digits.THIN}% intervals of {best} contain only "
            f"{digits.percent(coverage)} of the held-out values of {output}: they are too "
            "narrow."
        )
    return said


def _saturated(content: Content, output: str) -> list[str]:
    names = [
        name
        for name, by_output in content.regression.items()
        if output in by_output and _no_freedom(by_output[output])
    ]
    return (
        [
            f"{digits.listing(names)} of {output}: saturated, as many coefficients as runs. R² and "
            "residuals say nothing."
        ]
        if names
        else []
    )


def _no_freedom(table: xr.Dataset) -> bool:
    if "df_residual" in table:
        return float(table["df_residual"]) == 0.0
    return not np.isfinite(float(table["residual_sd"])) if "residual_sd" in table else False
