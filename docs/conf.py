"""How the pages are built: ``sphinx-build -W docs build/docs``, with raywright installed."""

import sys
from importlib.metadata import version as version_of
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

project = "raywright"
author = "the raywright authors"
release = version_of("raywright")
version = release

extensions = ["myst_parser", "sphinx.ext.autodoc", "numpydoc", "reference_pages"]
exclude_patterns = ["_build"]
html_theme = "furo"
html_title = "raywright"
html_static_path: list[str] = []

# One backtick names a thing in docstrings: it becomes a link where there is such a thing, and code where not.
default_role = "py:obj"
# Types stand in the docstrings, in words and shapes that annotations have not.
autodoc_typehints = "none"
autodoc_member_order = "bysource"
numpydoc_show_class_members = False

myst_heading_anchors = 3
