"""From an expensive simulation to a cheap model that can be trusted.

::

    from surrogate import Study

    study = Study.from_yaml("studies/ishigami.yaml")
    runs = study.run(workers=2)
    fits = study.fit(runs)
    table = study.compare(fits, runs)
    indices = study.sensitivity(fits, runs)
    study.report(runs, fits, table, indices).save("report.html")

`Campaign` drives a study from outside: ask for points, tell their answers.
"""

from typing import Any

__all__ = ["Campaign", "Study", "__version__"]


def __getattr__(name: str) -> Any:
    # On demand (PEP 562): solvers in worker processes import surrogate.solver and need none
    # of the packages that Study brings.
    if name == "Campaign":
        from surrogate.study.campaign import Campaign

        return Campaign
    if name == "Study":
        from surrogate.study.study import Study

        return Study
    if name == "__version__":
        from importlib.metadata import version

        return version("surrogate-studies")
    raise AttributeError(f"module 'surrogate' has no attribute '{name}'")
