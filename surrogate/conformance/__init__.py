"""The checks that the author of a plug-in runs: in a test, one line each. ::

    from surrogate.conformance import check_solver

    def test_contract():
        check_solver(Beam())

Each function returns nothing, or raises `PluginError` with a sentence for everything that
breaks the contract and what to do about it.
"""

from surrogate.conformance.designs import check_augmentation, check_design
from surrogate.conformance.regressors import check_regressor
from surrogate.conformance.solvers import check_solver

__all__ = ["check_augmentation", "check_design", "check_regressor", "check_solver"]
