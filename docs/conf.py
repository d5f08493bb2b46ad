"""The configuration of Sphinx for the site (`make docs`); its extensions are in _sphinx/."""

import re
import shutil
import sys
import warnings
from pathlib import Path
from typing import Any

import gaussmap
from numpydoc.xref import DEFAULT_LINKS
from sphinx.application import Sphinx
from sphinx.errors import ConfigError
from sphinx.ext import autosummary

HERE = Path(__file__).parent
# Cells of pages call these commands. Without one of them, a cell would wait for a file forever.
for command in ("dask", "gaussmap"):
    if shutil.which(command) is None:
        raise ConfigError(
            f"the command {command} is not on PATH, and pages call it: run `make docs`, or install "
            "'.[docs]' in an environment that is activated."
        )
sys.path.append(str(HERE / "_sphinx"))

# The modules of the classes that types in docstrings name. Functions return some classes that are
# not public.
CLASSES = {
    "gaussmap.curves": dir(gaussmap.curves),
    "gaussmap.gauss_map": dir(gaussmap.gauss_map),
    "gaussmap.tools.cad.part": ["Face", "Part", "Solid"],
    "gaussmap.runtime.spline.misfit": ["Misfit"],
    "gaussmap.runtime.samples.report": ["SamplingReport"],
    "gaussmap.tools.support.branches": ["Branches"],
    "gaussmap.tools.support.convolution": ["Convolution"],
    "gaussmap": dir(gaussmap),
}

project = "gaussmap"
author = "The gaussmap developers"
version = release = gaussmap.__version__

extensions = [
    "myst_nb",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx_copybutton",
    "sphinx_design",
    "formula_pages",
    "mathml",
]
# Python files are not pages: they write pages, figures and the notebooks of the gallery.
source_suffix = {".rst": "restructuredtext", ".md": "myst-nb", ".ipynb": "myst-nb"}
templates_path = ["_templates"]
exclude_patterns = ["_*", "**.py", "**.tmp"]

# Every reference must have a target. In docstrings, a public name between single backquotes becomes
# a link, other text becomes code.
nitpicky = True
nitpick_ignore_regex = [("py:obj", ".*")]
default_role = "py:obj"

# --- pages in Markdown, and notebooks ---
myst_enable_extensions = ["amsmath", "attrs_block", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 4
myst_fence_as_directive = ["math"]  # as on GitHub
# Cells of pages run while the site is built, and must not fail; the gallery has its outputs already
# (`make gallery`).
nb_execution_mode = "force"
nb_execution_excludepatterns = ["gallery/*"]
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_execution_in_temp = True
nb_merge_streams = True

# --- the reference ---
# Sentences do not end after these abbreviations.
autosummary.WELL_KNOWN_ABBREVIATIONS += ("Sect.", "Sects.", "eq.", "eqs.", "Fig.", "Figs.")
# Docstrings that formulas inherit from SymPy have sections of their own.
warnings.filterwarnings("ignore", message="Unknown section Explanation", module="numpydoc")
autosummary_ignore_module_all = False  # the public names are those of __all__ …
autosummary_imported_members = True  # … and are imported from where they are defined
autodoc_preserve_defaults = True
autodoc_typehints = "none"  # docstrings have the types
numpydoc_show_class_members = False  # the template of classes lists them
numpydoc_xref_param_type = True
# Classes of gaussmap in types become links, those of Python and NumPy do not: their pages are not
# local.
numpydoc_xref_ignore = "all"
numpydoc_xref_aliases = {name: name for name in DEFAULT_LINKS} | {
    name: f"{space}.{name}"
    for space, names in CLASSES.items()
    for name in names
    if name[0].isupper()
}
autosummary_context = {"catalogue": list(gaussmap.surfaces.names())}

# --- what browsers get: nothing is loaded from elsewhere ---
html_theme = "pydata_sphinx_theme"
html_title = f"gaussmap {release}"
html_static_path = ["_static"]
html_extra_path = ["../out/extra"] if (HERE.parent / "out" / "extra").exists() else []  # the viewer
html_css_files = ["site.css"]
html_math_renderer = "mathml"
html_copy_source = False
html_show_sourcelink = False
html_theme_options = {
    "navigation_with_keys": False,
    "show_prev_next": True,
    "header_links_before_dropdown": 6,
    "footer_start": ["copyright"],
    "footer_end": [],
}
html_context = {"default_mode": "auto"}


def setup(app: Sphinx) -> None:
    """Have |K| in docstrings mean the absolute value of K, not a substitution."""
    app.connect("autodoc-process-docstring", _escape_bars, priority=100)


def _escape_bars(*arguments: Any) -> None:  # noqa: ANN401
    lines: list[str] = arguments[-1]
    lines[:] = [re.sub(r"\|(\w+)\|", r"\|\1\|", line) for line in lines]
