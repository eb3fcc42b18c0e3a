"""How the documentation is built: `sphinx-build -W --keep-going -n docs build/docs`.

Nothing is fetched while it is built, and its pages need no network: formulas are MathML, fonts
are those of the system.
"""

from __future__ import annotations

import os
import sys
from importlib.metadata import version as installed
from pathlib import Path

DOCS = Path(__file__).parent
sys.path.insert(0, str(DOCS / "ext"))

# What the pages' commands print is text, of a width that fits the page.
os.environ |= {
    "COLUMNS": "80",
    "NO_COLOR": "1",
    "TTY_COMPATIBLE": "0",
    "PROJECT": str(DOCS.parent),
    "PATH": os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")]),
    "PYDEVD_DISABLE_FILE_VALIDATION": "1",
}

project = "surrogate-studies"
author = "the authors of surrogate-studies"
version = release = installed("surrogate-studies")

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx_copybutton",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
    "cells",
    "docstrings",
    "generated",
    "mathml",
    "repository",
]
exclude_patterns = ["gallery/*", "gallery_of_studies/*.ipynb", "reference/generated/*"]
templates_path = ["_templates"]
default_role = "code"
nitpicky = True
# There are no inventories of other packages to look in: that would need the network. Classes that
# only signatures name have no page; what a page names by a role must exist.
nitpick_ignore_regex = [(r"py:.*", r"(?!surrogate\b).*"), (r"py:class", r"surrogate\..*")]

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 4
myst_links_external_new_tab = False
nb_execution_mode = "force"
nb_execution_in_temp = True
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_merge_streams = True

autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
autosummary_generate = True
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 88

sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "gallery_of_studies",
    "filename_pattern": r"/study_",
    "download_all_examples": False,
    "remove_config_comments": True,
    "show_memory": False,
    "show_signature": False,
    "write_computation_times": False,
    "within_subsection_order": "FileNameSortKey",
    "abort_on_example_error": True,
    "reset_modules": ("matplotlib", "gallery_style.reset"),
}

html_theme = "furo"
html_title = "surrogate-studies"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False
html_show_copyright = False
html_math_renderer = "mathml"
copybutton_prompt_text = r"\$ |>>> "
copybutton_prompt_is_regexp = True
