"""Recipes are notebooks: the cells of each page are run in order, in one namespace, in an empty folder.

Each page asserts what must come out. Cells that import matplotlib draw figures; without
it they are left out. A page that imports another package is skipped where that is not installed.
"""

import ast
import re
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

import raywright as rw

DOCS = Path(__file__).parents[3] / "docs"
RECIPES = sorted((DOCS / "recipes").glob("*.md"))
PAGES = [page for page in RECIPES if page.stem != "index"]
CELL = re.compile(r"^```\{code-cell\} python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
HEAD = """---
jupytext:
  text_representation:
    extension: .md
    format_name: myst
kernelspec:
  display_name: Python 3
  language: python
  name: python3
---

# """


def cells(page):
    """Return the code of each cell, below so many empty lines that its lines have the numbers of the page."""
    text = page.read_text(encoding="utf-8")
    return ["\n" * text.count("\n", 0, found.start(1)) + found[1] for found in CELL.finditer(text)]


def imported(code):
    """Return the top-level packages that code imports."""
    names = set()
    for node in ast.walk(ast.parse(code)):
        if isinstance(node, ast.Import):
            names |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names.add(node.module.partition(".")[0])
    return names


@pytest.fixture
def figures(monkeypatch):
    """Draw into memory, and close all figures afterwards."""
    monkeypatch.setenv("MPLBACKEND", "Agg")
    yield
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_recipe_comes_out_as_it_says(page, tmp_path, monkeypatch, figures):
    monkeypatch.chdir(tmp_path)
    namespace = {"__name__": "__recipe__"}
    for code in cells(page):
        missing = {name for name in imported(code) if find_spec(name) is None}
        if missing == {"matplotlib"}:
            continue
        if missing:
            pytest.skip(f"{', '.join(sorted(missing))} is not installed")
        exec(compile(code, page, "exec"), namespace)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_recipe_is_a_short_notebook_that_asserts_something(page):
    text = page.read_text(encoding="utf-8")
    assert text.startswith(HEAD)
    assert text.count("```") == 2 * len(cells(page)), "all code of a recipe stands in cells"
    lines = [line for code in cells(page) for line in code.splitlines() if line.strip()]
    assert len(lines) <= 40
    assert max(map(len, lines)) <= 110
    # Assertions must not depend on whether figures are drawn.
    assert any(
        isinstance(node, ast.Assert)
        for code in cells(page)
        if "matplotlib" not in imported(code)
        for node in ast.walk(ast.parse(code))
    )


def test_every_recipe_is_in_the_list_of_recipes():
    index = (DOCS / "recipes" / "index.md").read_text(encoding="utf-8")
    linked = re.findall(r"\]\((\w+)\.md\)", index)
    assert sorted(linked) == [page.stem for page in PAGES]


@pytest.mark.parametrize("page", ["words.md", "which_call.md"])
def test_tables_name_calls_that_are_there(page):
    text = (DOCS / page).read_text(encoding="utf-8")
    short = {
        "s": rw.Scene,
        "scene": rw.Scene,
        "m": rw.measure,
        "hits": rw.query.Hits,
        "mesh": rw.Mesh,
        "image": rw.Image,
    }
    for code in re.findall(r"`([^`]+)`", text):
        for name, part in re.findall(r"(?<![\w./])(\w+)\.(\w+)", code):
            if name in short:
                fields = getattr(short[name], "__dataclass_fields__", {})
                assert hasattr(short[name], part) or part in fields, f"{page}: {name}.{part}"


@pytest.mark.parametrize("page", ["recipes/index.md", "words.md", "which_call.md"])
def test_links_lead_to_pages_and_headings(page):
    source = DOCS / page
    for link in re.findall(r"\]\(([^)\s]+)\)", source.read_text(encoding="utf-8")):
        path, _, heading = link.partition("#")
        target = (source.parent / path).resolve() if path else source
        if "reference" in target.parts:
            continue  # made from docstrings when the pages are built
        assert target.exists(), link
        titles = re.findall(r"^#+ (.*)$", target.read_text(encoding="utf-8"), re.MULTILINE)
        slugs = {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}
        assert not heading or heading in slugs, link
