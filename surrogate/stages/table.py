"""The stages of a study after its runs, a row a stage.

A stage reads parts of the study and needs what earlier stages gave. It is done again when
one of these has changed, or the packages or plug-ins that it is made with. To add one, add a
row, and a module with its function; `summary.json` gets its figures, the results folder its
files, and `Content` (the report) a field of its name when the report is to show it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from surrogate.runs.netcdf import encoded
from surrogate.stages import (
    adaptive,
    calibration,
    candidates,
    fits,
    learning,
    portable,
    reliability,
    sensitivity,
    solve,
)
from surrogate.stages.aliasing import aliasing
from surrogate.stages.comparison import comparison
from surrogate.stages.failures import failures
from surrogate.stages.noise import noise
from surrogate.stages.reduced_study import reduced_study
from surrogate.stages.regression import regression, tree
from surrogate.stages.replicates import replicates
from surrogate.stages.report import report
from surrogate.stages.scene import scene
from surrogate.stages.screening import screening
from surrogate.stages.stage import Files, Stage, by_problem
from surrogate.stages.summary import figures_by_output, figures_of, json_data, summary, text
from surrogate.stages.suspicious import suspicious
from surrogate.stages.validation import validation

#: What the walk is given to start from.
GIVEN = ("runs", "cases")
REPORT, SUMMARY = "report.html", "summary.json"


def _file(name: str, content: Callable[[Any], bytes | memoryview]) -> Files:
    """One file, which is not there when the stage has nothing to give."""
    return Files(name, lambda value: {} if value is None or value == "" else {name: content(value)})


def _netcdf(
    name: str, of: Callable[[Any], Any] = lambda found: found, *, compressed: bool = False
) -> Files:
    """A dataset or a tree as netCDF4; none when the stage has nothing to give.

    Made in memory: HDF5 ends the process when a disk fills under it. of: value -> dataset or tree
    """

    def contents(value: Any) -> Mapping[str, memoryview]:
        found = None if value is None else of(value)
        return {} if found is None else {name: encoded(found, compressed=compressed)}

    return Files(name, contents)


STAGES = (
    Stage(
        "dataset",
        reads=("text",),
        needs=("runs",),
        does=lambda text, runs: runs.assign_attrs(study=text),
        files=_netcdf("runs.nc"),
        kept=False,
    ),
    Stage(
        "source",
        reads=("text",),
        needs=(),
        does=lambda text: text,
        files=_file("study.yaml", str.encode),
        kept=False,
    ),
    Stage("aliasing", reads=("space",), needs=("runs",), does=aliasing),
    Stage(
        "failures",
        reads=("space",),
        needs=("runs",),
        does=failures,
        figures=lambda found: {**vars(found), "sentence": str(found)} if found else None,
    ),
    Stage(
        "replicates",
        reads=("outputs", "deterministic"),
        needs=("runs",),
        does=replicates,
        figures=lambda found: json_data({name: vars(one) for name, one in found.items()}),
    ),
    Stage(
        "fits",
        reads=("space", "surrogates", "outputs"),
        needs=("runs",),
        jobs=fits.jobs,
        each=("space",),
        does=fits.gather,
    ),
    Stage(
        "portable",
        reads=(),
        needs=("fits",),
        does=portable.portable,
        files=Files("surrogates/*.json", portable.documents),
        kept=False,
    ),
    Stage(
        "comparison",
        reads=("outputs",),
        needs=("runs", "fits"),
        does=comparison,
        files=_netcdf("comparison.nc"),
        figures=figures_of,
    ),
    Stage(
        "noise",
        reads=("outputs",),
        needs=("runs", "fits", "replicates"),
        does=noise,
        figures=lambda found: json_data({name: vars(one) for name, one in found.items()}),
    ),
    Stage(
        "suspicious",
        reads=(),
        needs=("runs", "fits"),
        does=suspicious,
        figures=lambda found: json_data({name: vars(one) for name, one in found.items()}),
    ),
    Stage(
        "sensitivity",
        reads=("sensitivity_method", "space", "outputs"),
        needs=("runs", "fits", "comparison"),
        jobs=sensitivity.jobs,
        does=sensitivity.gather,
        files=_netcdf("sensitivity.nc"),
        figures=figures_of,
    ),
    Stage(
        "regression",
        reads=("deterministic",),
        needs=("fits",),
        does=regression,
        files=_netcdf("regression.nc", tree),
        figures=figures_by_output,
    ),
    Stage(
        "screening",
        reads=("screening_rule", "sensitivity_method", "space", "outputs", "nominal"),
        needs=("fits", "comparison", "sensitivity"),
        does=screening,
        figures=lambda found: json_data(found.summary()) if found else None,
    ),
    Stage(
        "reduced_study",
        reads=("name", "about", "words"),
        needs=("screening",),
        does=reduced_study,
        files=_file("study_reduced.yaml", str.encode),
        kept=False,
    ),
    Stage(
        "adaptive",
        reads=("rules", "space"),
        needs=("runs",),
        does=adaptive.adaptive,
        figures=adaptive.figures,
    ),
    Stage(
        "learning",
        reads=("learning_rule", "sensitivity_method", "space", "surrogates"),
        needs=("runs", "fits", "comparison", "noise"),
        jobs=learning.jobs,
        does=learning.gather,
        files=_netcdf("learning.nc"),
        figures=figures_of,
    ),
    Stage(
        "candidates",
        reads=("problems", "space", "recorded"),
        needs=("fits", "comparison"),
        jobs=candidates.jobs,
        does=by_problem,
    ),
    Stage(
        "solve",
        reads=(),
        needs=("runs", "candidates"),
        does=solve.solve,
        files=_netcdf("solve.nc", solve.tree),
        figures=solve.figures,
        kept=False,
    ),
    Stage(
        "reliability",
        reads=("limits", "space"),
        needs=("fits", "comparison"),
        jobs=reliability.jobs,
        does=by_problem,
        files=_netcdf("reliability.nc", reliability.tree),
        figures=reliability.figures,
    ),
    Stage(
        "posterior",
        reads=("measured",),
        needs=("fits", "comparison"),
        jobs=calibration.jobs,
        does=calibration.gather,
        files=_netcdf("posterior.nc", lambda found: found.tree, compressed=True),
    ),
    Stage(
        "calibration",
        reads=(),
        needs=("runs", "posterior", "fits", "comparison"),
        does=calibration.calibration,
        figures=calibration.figures,
        kept=False,
    ),
    Stage(
        "validation",
        reads=("validation_rule", "space", "offered", "fixed"),
        needs=("fits", "cases"),
        does=validation,
        files=_netcdf("validation.nc"),
        figures=figures_of,
    ),
    Stage("scene", reads=("scene_of", "space", "fixed"), needs=(), does=scene),
    Stage(
        "report",
        reads=("name", "about", "space"),
        needs=(
            "dataset",
            "aliasing",
            "failures",
            "replicates",
            "noise",
            "suspicious",
            "fits",
            "comparison",
            "regression",
            "sensitivity",
            "screening",
            "adaptive",
            "learning",
            "solve",
            "reliability",
            "calibration",
            "reduced_study",
            "validation",
            "scene",
            "not_done",
        ),
        does=report,
        files=_file(REPORT, lambda page: page.html.encode()),
        kept=False,
    ),
    Stage(
        "summary",
        reads=("name",),
        needs=("runs", "figures", "not_done", "stamp"),
        does=summary,
        files=_file(SUMMARY, lambda found: text(found).encode()),
        kept=False,
    ),
)
