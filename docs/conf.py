"""The documentation site: `make docs` builds it, offline and complete in itself, into site/."""

import logging
import sys
import warnings
from importlib.metadata import version as installed
from pathlib import Path

DOCS = Path(__file__).parent
sys.path[:0] = [str(DOCS / "extensions"), str(DOCS.parent)]

project = "runningbond"
author = "the authors of runningbond"
release = version = installed("runningbond")
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "numpydoc",
    "sphinx_gallery.gen_gallery",
    "sphinxcontrib.bibtex",
    "mathml",
    "moments",
    "sources",
]
exclude_patterns = ["gallery", "gallery-of-examples/**/*.ipynb", "gallery-of-examples/**/*.py"]
default_role = "py:obj"
nitpicky = False

myst_enable_extensions = ["amsmath", "dollarmath", "deflist", "attrs_block", "colon_fence"]
myst_heading_anchors = 4
suppress_warnings = ["config.cache"]  # functions of this file cannot be pickled

autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
numpydoc_show_class_members = False

bibtex_bibfiles = ["../CITATIONS.bib"]
bibtex_default_style = "unsrt"
bibtex_reference_style = "author_year"

numfig = True
numfig_secnum_depth = 1

html_theme = "furo"
html_title = "runningbond"
SHARED = "../runningbond/compare/templates"
html_static_path = ["static", f"{SHARED}/moments.js", f"{SHARED}/walls.css"]
html_css_files = ["walls.css", "site.css"]
html_js_files = ["moments.js"]
html_math_renderer = "mathml"
html_copy_source = False
html_show_sphinx = False
html_show_copyright = False

for page in (DOCS / "gallery-of-examples").glob("*/*.rst"):  # of examples that are no more
    if page.stem != "index" and not (DOCS / "gallery" / page.parent.name / f"{page.stem}.py").exists():
        page.unlink()

# accessible_pygments, which furo uses, would have every library tell what it does
for talkative in ("ezdxf", "fontTools", "matplotlib", "skfem"):
    logging.getLogger(talkative).setLevel(logging.WARNING)
warnings.filterwarnings("ignore", "FigureCanvasAgg is non-interactive", UserWarning)

sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "gallery-of-examples",
    "filename_pattern": r"\.py$",
    "within_subsection_order": "FileNameSortKey",
    "abort_on_example_error": True,
    "show_memory": False,
    "show_signature": False,
    "download_all_examples": False,
    "write_computation_times": False,
    "min_reported_time": 1e9,
    "remove_config_comments": True,
    "reset_modules": ("matplotlib", "sources.cropped"),
    "capture_repr": (),
    "reference_url": dict.fromkeys(("dem", "homog", "runningbond")),
}
