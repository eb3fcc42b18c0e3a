"""Surrogates of other packages, called as this package's are, for `study_layer`.

The others run at their defaults, or as their documentation advises for the task:
scikit-learn's process has a Matern 5/2 kernel with a length for each input, a nugget and two
restarts; OpenTURNS' the same kernel and its default search; SMT's KRG a Matern 5/2 kernel.
OpenTURNS' expansion is sparse (least angle regression by corrected leave-one-out), chaospy's
by scikit-learn's LassoLarsCV, both of degree 8 in three inputs and 3 in seven or eight.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from surrogate.regressors.chaos import PolynomialChaos
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

OURS = "this package"
MODULES = {"scikit-learn": "sklearn", "SALib": "SALib"}  # where it is not the name in small letters
Work = TypeVar("Work")


@dataclass(frozen=True)
class Fitted:
    """What a program made of runs.

    predict   points (m, d) -> mean (m,) or (m, 1)
    spread    points -> mean and deviation (or variance)
    indices   -> first-order and total Sobol' indices
    """

    predict: Callable[[np.ndarray], np.ndarray]
    spread: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]] | None = None
    indices: Callable[[], tuple[np.ndarray, np.ndarray]] | None = None


Fitting = Callable[[np.ndarray, np.ndarray], Fitted]


def only_installed(programs: dict[str, Work]) -> dict[str, Work]:
    """The programs whose package is here, ours first."""
    return {
        program: work
        for program, work in programs.items()
        if program == OURS or importlib.util.find_spec(MODULES.get(program, program.lower()))
    }


def processes(size: int) -> dict[str, Fitting]:
    """Gaussian processes of `size` coded inputs."""
    space = Space(tuple(Parameter(f"x{i}", uniform(-1.0, 1.0)) for i in range(size)))

    def of_estimator(model) -> Fitted:
        return Fitted(model.predict, lambda x: model.predict(x, return_std=True))

    def ours(x: np.ndarray, y: np.ndarray) -> Fitted:
        return of_estimator(GaussianProcess(space=space).fit(x, y))

    def scikit_learn(x: np.ndarray, y: np.ndarray) -> Fitted:
        from sklearn.gaussian_process import GaussianProcessRegressor, kernels

        kernel = kernels.ConstantKernel(1.0, (1e-3, 1e6)) * kernels.Matern(
            np.full(size, 2.0), (0.05, 50.0), nu=2.5
        ) + kernels.WhiteKernel(1e-4, (1e-10, 1.0))
        process = GaussianProcessRegressor(
            kernel, normalize_y=True, n_restarts_optimizer=2, random_state=0
        )
        return of_estimator(process.fit(x, y))

    def smt(x: np.ndarray, y: np.ndarray) -> Fitted:
        from smt.surrogate_models import KRG

        model = KRG(corr="matern52", theta0=[1e-2] * size, print_global=False, seed=0)
        model.set_training_values(x, y)
        model.train()
        return Fitted(
            model.predict_values, lambda at: (model.predict_values(at), model.predict_variances(at))
        )

    def openturns(x: np.ndarray, y: np.ndarray) -> Fitted:
        import openturns as ot

        middle, scale = y.mean(), y.std()
        fitter = ot.GaussianProcessFitter(
            sample(x),
            sample((y - middle) / scale),
            ot.MaternModel([2.0] * size, [1.0], 2.5),
            ot.ConstantBasisFactory(size).build(),
        )
        fitter.run()
        algorithm = ot.GaussianProcessRegression(fitter.getResult())
        algorithm.run()
        mean = algorithm.getResult().getMetaModel()
        return Fitted(lambda at: middle + scale * np.array(mean(sample(at))))

    found = {OURS: ours, "scikit-learn": scikit_learn, "SMT": smt, "OpenTURNS": openturns}
    return only_installed(found)


def expansions(size: int) -> dict[str, Fitting]:
    """Polynomial chaos expansions of `size` coded inputs."""
    space = Space(tuple(Parameter(f"x{i}", uniform(-1.0, 1.0)) for i in range(size)))
    degree = 8 if size < 5 else 3

    def ours(x: np.ndarray, y: np.ndarray) -> Fitted:
        model = PolynomialChaos(space=space).fit(x, y)

        def indices() -> tuple[np.ndarray, np.ndarray]:
            found = model.sobol_indices()
            return found.first_order, found.total

        return Fitted(model.predict, indices=indices)

    def openturns(x: np.ndarray, y: np.ndarray) -> Fitted:
        import openturns as ot

        numbering = ot.LinearEnumerateFunction(size)
        basis = ot.OrthogonalProductPolynomialFactory([ot.LegendreFactory()] * size, numbering)
        terms = numbering.getBasisSizeFromTotalDegree(degree)
        chosen = ot.LeastSquaresStrategy(
            ot.LeastSquaresMetaModelSelectionFactory(ot.LARS(), ot.CorrectedLeaveOneOut())
        )
        law = ot.JointDistribution([ot.Uniform(-1.0, 1.0)] * size)
        algorithm = ot.FunctionalChaosAlgorithm(
            sample(x), sample(y), law, ot.FixedStrategy(basis, terms), chosen
        )
        algorithm.run()
        result = algorithm.getResult()
        mean = result.getMetaModel()

        def indices() -> tuple[np.ndarray, np.ndarray]:
            found = ot.FunctionalChaosSobolIndices(result)
            return (
                np.array([found.getSobolIndex(i) for i in range(size)]),
                np.array([found.getSobolTotalIndex(i) for i in range(size)]),
            )

        return Fitted(lambda at: np.array(mean(sample(at))), indices=indices)

    def chaospy(x: np.ndarray, y: np.ndarray) -> Fitted:
        import chaospy as cp
        from sklearn.linear_model import LassoLarsCV

        law = cp.Iid(cp.Uniform(-1.0, 1.0), size)
        terms = cp.generate_expansion(degree, law, normed=True)
        model = LassoLarsCV(fit_intercept=False)
        polynomial = cp.fit_regression(terms, x.T, y, model=model)
        return Fitted(
            lambda at: np.array(polynomial(*at.T)),
            indices=lambda: (cp.Sens_m(polynomial, law), cp.Sens_t(polynomial, law)),
        )

    return only_installed({OURS: ours, "OpenTURNS": openturns, "chaospy": chaospy})


def sample(values: np.ndarray):
    """OpenTURNS' sample of points (m, d) or values (m,)."""
    import openturns as ot

    return ot.Sample(np.atleast_2d(values.T).T.tolist())
