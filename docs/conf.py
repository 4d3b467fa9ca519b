"""The documentation site: `python -m sphinx -W --keep-going -b html docs build/site`."""

from __future__ import annotations

import sys
from pathlib import Path

import compoundkin

# the extensions of this site stand beside it
sys.path.insert(0, str(Path(__file__).parent / "_ext"))

project = "compoundkin"
author = "the authors of compoundkin"
project_copyright = author
release = compoundkin.__version__
language = "en"

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "navigation",
    "gallery",
    "references",
    "mathml",
]
exclude_patterns = ["_ext", "**.ipynb_checkpoints"]

# Pages are plain Markdown, readable where no site is built.
myst_heading_anchors = 3
myst_enable_extensions = ["colon_fence", "dollarmath"]

# Notebooks are stored without their results; one that cannot be run stops the build.
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_show_tb = True
nb_execution_timeout = 120
nb_merge_streams = True

# Docstrings are plain text with names in single backticks.
default_role = "name"
autosummary_generate = False
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
autodoc_type_aliases = {"Number": "Number"}
autodoc_default_options = {"members": True}
python_maximum_signature_line_length = 88
toc_object_entries_show_parents = "hide"

html_theme = "furo"
html_title = f"compoundkin {release}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_sphinx = False
html_copy_source = False
html_theme_options = {"navigation_with_keys": True}
