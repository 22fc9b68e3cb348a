"""The pages on the code name what is there: files, functions, terms, and links between pages."""

import re
import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
PATHS = sorted((ROOT / "docs/architecture").glob("*.md"))
PAGES = [ROOT / "ARCHITECTURE.md", ROOT / "docs/glossary.md", *PATHS]
MERMAID = re.compile(r"^```mermaid\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def read(path):
    return path.read_text(encoding="utf-8")


def name(path):
    return path.relative_to(ROOT).as_posix()


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_a_path_is_short_drawn_and_has_its_stops(path):
    text = read(path)
    assert len(text.split()) <= 600
    assert [diagram.split()[0] for diagram in MERMAID.findall(text)] == ["sequenceDiagram"]
    assert 8 <= len(re.findall(r"^\d+\. `[\w./]+:\w+`", text, re.MULTILINE)) <= 12


@pytest.mark.parametrize("path", PAGES, ids=name)
def test_files_that_a_page_names_are_there(path):
    named = re.findall(r"`((?:benches|docs|examples|python|rust|tests)/[\w./-]*\w/?)(?::\w+)?`", read(path))
    assert named
    for file in named:
        assert (ROOT / file).exists(), f"{name(path)} names {file}"


@pytest.mark.parametrize("path", PAGES, ids=name)
def test_functions_that_a_page_names_are_there(path):
    for file, function in re.findall(r"`([\w./]+):(\w+)`", read(path)):
        assert re.search(rf"\b(?:fn|def) {function}\b", read(ROOT / file)), f"{file} has no {function}"


@pytest.mark.parametrize("path", PAGES, ids=name)
def test_pages_that_a_page_links_to_are_there(path):
    for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", read(path)):
        assert (path.parent / link).exists(), f"{name(path)} links to {link}"


def test_pages_that_are_read_first_are_short():
    assert len(read(ROOT / "README.md").splitlines()) <= 120
    assert len(read(ROOT / "ARCHITECTURE.md").split()) <= 1000
    first = re.search(r"^## 0\.2\.0$.*?(?=^## |\Z)", read(ROOT / "CHANGELOG.md"), re.MULTILINE | re.DOTALL)
    assert len(first[0].splitlines()) <= 60


def test_every_path_is_on_the_page_of_the_architecture():
    linked = re.findall(r"\]\((docs/architecture/\w+\.md)\)", read(ROOT / "ARCHITECTURE.md"))
    assert sorted(linked) == [name(path) for path in PATHS]


def test_the_glossary_has_each_term_once_in_order():
    rows = re.findall(
        r"^\| (.+?) \| (.+?) \| .*? \| `[\w./]+` \|$", read(ROOT / "docs/glossary.md"), re.MULTILINE
    )
    terms = [term.lower() for term, meaning in rows if meaning.endswith(".")]
    assert len(terms) >= 60
    assert terms == sorted(set(terms))
    # Every row has this form, but for the head.
    assert len(terms) == len(re.findall(r"^\| ", read(ROOT / "docs/glossary.md"), re.MULTILINE)) - 1


def test_diagrams_are_drawn_without_a_script():
    script = ROOT / "docs/diagrams.py"
    if not script.exists():
        pytest.skip("only the repository builds its pages")
    svg = runpy.run_path(str(script))["svg"]
    for path in PAGES:
        for diagram in MERMAID.findall(read(path)):
            drawn = svg(diagram)
            shown = re.findall(r"<text [^>]*>(.*?)</text>", drawn)
            messages = re.findall(r">>\w+: (.+)", diagram)
            assert messages == [] or [text for text in shown if text in messages] == messages
            assert "<script" not in drawn
    with pytest.raises(ValueError, match="not understood: 'A=>B'"):
        svg("sequenceDiagram\n  participant A\n  A=>B")
    with pytest.raises(ValueError, match="got 'pie'"):
        svg("pie\n")
