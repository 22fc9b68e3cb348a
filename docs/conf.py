"""Configuration of Sphinx: ``sphinx-build -W docs build/docs``, with raywright installed."""

import sys
from importlib.metadata import version as version_of
from importlib.util import find_spec
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

project = "raywright"
author = "the raywright authors"
release = version_of("raywright")
version = release

extensions = ["myst_nb", "sphinx.ext.autodoc", "numpydoc", "reference_pages", "diagrams"]
exclude_patterns = ["_build", "_templates"]
html_theme = "furo"
html_title = "raywright"
html_static_path: list[str] = []
templates_path = ["_templates"]
# Furo's own, and below them the versions beside this one.
html_sidebars = {
    "**": [
        "sidebar/brand.html",
        "sidebar/search.html",
        "sidebar/scroll-start.html",
        "sidebar/navigation.html",
        "versions.html",
        "sidebar/scroll-end.html",
    ]
}

# A name in single backticks in docstrings becomes a link, or code if there is no such name.
default_role = "py:obj"
# Docstrings give types in words and with shapes, which annotations lack.
autodoc_typehints = "none"
autodoc_member_order = "bysource"
numpydoc_show_class_members = False

myst_heading_anchors = 3
# ```mermaid is a directive of `diagrams`.
myst_fence_as_directive = ["mermaid"]

# Recipes are notebooks; they run when their code has changed. Without torch, its recipe is not run.
nb_execution_mode = "cache"
nb_execution_timeout = 120
nb_execution_raise_on_error = True
nb_execution_excludepatterns = [] if find_spec("torch") else ["recipes/torch_tensors.md"]
nb_execution_show_tb = True
# Bars of progress.
nb_output_stderr = "remove"
