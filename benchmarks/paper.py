"""Figures of Chassagne et al. 2018 beside those of the shipped studies: a Markdown table.

    python benchmarks/paper.py

Everything is computed from the runs stored beside the studies, in a minute or two; no run
of the finite element model is done.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from surrogate import Study
from surrogate.sensitivity.one_at_a_time import main_effects
from surrogate_solvers.leg_bandage.geometry.basis import shipped_basis
from surrogate_solvers.leg_bandage.geometry.cohort import load_cohort

STUDIES = Path(__file__).parent.parent / "studies"
TABLE_3 = {
    "1": 32.73,
    "mu_skin": 2.70,
    "tension": 11.54,
    "leg_length": 2.85,
    "alpha1": 4.54,
    "alpha2": 3.92,
    "alpha3": -1.74,
    "alpha4": -0.51,
}
B1 = "pressure_b1"


def main() -> None:
    """Print the table."""
    print("| figure | paper | here |\n|---|---|---|")
    for rows in (screening(), stretches(), coefficients(), surrogates(), geometry(), validation()):
        for name, paper, ours in rows:
            print(f"| {name} | {paper} | {ours} |")


def loaded(name: str):
    """A study and its stored runs."""
    study = Study.from_yaml(STUDIES / f"{name}.yaml")
    return study, study.stored()


def screening():
    """Shares of the effects of one parameter at a time, and total Sobol' indices."""
    study, runs = loaded("bandage_screening")
    train = runs.isel(run=(runs["design"] == "train").values)
    shares = main_effects(study.space, train["coded"].values, train[B1].values, output=B1)
    fits = study.fit(runs)
    indices = study.sensitivity(fits, runs).sel(output=B1)
    parameters = list(study.space.names)
    effect = dict(zip(parameters, shares["share"].squeeze().values, strict=True))
    together = effect["tension"] + effect["mu_skin"]
    total = ", ".join(
        f"{name} {float(indices['total'].sel(parameter=name)):.3f} "
        f"({float(indices['total_low'].sel(parameter=name)):.3f}.."
        f"{float(indices['total_high'].sel(parameter=name)):.3f})"
        for name in parameters
    )
    single = ", ".join(f"{name} {100 * share:.1f} %" for name, share in effect.items())
    yield (
        "mu_skin and tension, share of the effects on the mean leg",
        "> 93 %",
        f"{100 * together:.1f} % ({single})",
    )
    yield "total Sobol' indices on the mean leg", "not done", total


def stretches():
    """Mean and standard deviation over the nine runs."""
    _, runs = loaded("bandage_reduction")
    nine = runs.isel(run=(runs["design"] == "train").values)
    for line, paper in (
        ("midline", "1.282 ± 0.001"),
        ("top", "1.411 ± 0.004"),
        ("bottom", "1.139 ± 0.002"),
    ):
        values = nine[f"stretch_{line}"].values
        edge = line if line == "midline" else f"{line} edge"
        yield f"stretch, {edge}", paper, f"{values.mean():.3f} ± {values.std(ddof=1):.3f}"
    mu, slip = nine["mu_skin"].values, nine["slip_max"].values
    yield (
        "largest slip in the nine runs, mu_skin 0.1 / 0.3",
        "slides down / holds",
        f"{slip[mu < 0.15].max():.0f} / {slip[mu > 0.25].max():.0f} mm",
    )


def coefficients():
    """The nine-run model beside the models with more runs."""
    study, runs = loaded("bandage_reduction")
    tables = {name: by[B1] for name, by in study.regressions(study.fit(runs)).items()}
    for term, paper in TABLE_3.items():
        ours = "; ".join(
            _coefficient(tables[name], term) for name in ("linear", "linear_folded", "interactions")
        )
        yield (
            f"{'mean' if term == '1' else term}, mmHg: 9 runs; folded; with interactions",
            f"{paper:.2f}",
            ours,
        )
    linear = tables["linear"]
    yield (
        "R², F test of the nine-run model",
        "0.99, p = 0.02",
        f"{float(linear['r2']):.4f}, p = {float(linear['f_p']):.2g}",
    )


def _coefficient(table, term: str) -> str:
    row = table.sel(term=term)
    return f"{float(row['coefficient']):.2f} ± {float(row['high'] - row['coefficient']):.2f}"


def surrogates():
    """Held-out Q2, friction's indices, and what the sensor's place does."""
    study, runs = loaded("bandage_surrogates")
    fits = study.fit(runs)
    table = study.compare(fits, runs)
    figures = table.sel(output=B1)
    held_out = ", ".join(
        f"{name} {float(figures['q2_test'].sel(surrogate=name)):.3f} "
        f"({float(figures['rmse_test'].sel(surrogate=name)):.2f})"
        for name in study.surrogates
    )
    yield "Q² on held-out runs (RMSE, mmHg)", "not done", held_out
    indices = study.sensitivity(fits, runs, table).sel(output=B1)
    total = ", ".join(
        f"{name} {float(indices['total'].sel(parameter=name)):.3f}" for name in study.space.names
    )
    yield (
        "total Sobol' indices, seven parameters",
        "β²/Σβ²: tension 0.71, alpha1 0.11, alpha2 0.08, leg_length 0.04, mu_skin 0.04",
        total,
    )
    pairs = indices["second_order"].sel(parameter="mu_skin")
    mixed = sum(
        float(pairs.sel(parameter_2=name))
        for name in study.space.names
        if name.startswith("alpha") or name == "leg_length"
    )
    yield "friction × geometry, share of the variance", "left open", f"{100 * mixed:.2f} %"
    moved = runs["sensor_variation"].values
    moved = moved[np.isfinite(moved)]
    yield (
        "sensor moved by 10 mm, mmHg",
        "1.27 ± 0.38",
        f"{moved.mean():.2f} ± {moved.std(ddof=1):.2f}",
    )
    effect = fits["interactions"][B1].estimator.regression_table(deterministic=True)
    yield "friction, half range at the centre, mmHg", "2.7", _coefficient(effect, "mu_skin")


def geometry():
    """What four modes lose, and how many validation legs lie outside."""
    basis = shipped_basis()
    legs = load_cohort("val")
    alphas = np.array([basis.project(one) for one in legs.snapshots().T])
    low, high = np.array(basis.ranges).T
    train = load_cohort()
    out = ((alphas < low) | (alphas > high)).any(axis=1)
    out |= (legs.length < train.length.min()) | (legs.length > train.length.max())
    yield "legs outside the range of the basis", "7 of 38", f"{out.sum()} of {len(legs)}"


def validation():
    """Models against the finite element model on legs' own sections."""
    study, runs = loaded("bandage_validation")
    found = study.validate(study.fit(runs)).sel(output=B1)
    printed = {
        "reduced": "1.04, 0.40, 9.7 % (against measurements)",
        "laplace": "0.88, 0.61, -11.6 % (against measurements)",
        "gp": "not done",
    }
    for name, paper in printed.items():
        one = found.sel(model=name)
        yield (
            f"{name}: slope through the origin, R², mean error, limits of agreement",
            paper,
            (
                f"{float(one['slope']):.3f}, {float(one['r2_correlation']):.2f}, "
                f"{float(one['mean_error_percent']):+.1f} %, {float(one['lower_limit']):+.1f}.."
                f"{float(one['upper_limit']):+.1f} mmHg (n = {int(one['n'])})"
            ),
        )


if __name__ == "__main__":
    main()
