"""From an expensive simulation to a cheap model that can be trusted.

::

    from surrogate import Study

    study = Study.from_yaml("studies/ishigami.yaml")
    runs = study.run(workers=2)
    fits = study.fit(runs)
    table = study.compare(fits, runs)
    indices = study.sensitivity(fits, runs)
    study.report(runs, fits, table, indices).save("report.html")
"""

from importlib.metadata import version

__version__ = version("surrogate-studies")
