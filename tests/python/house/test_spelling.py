"""Code and prose are spelled the American way, as the names of numpy, pbrt and Mitsuba are."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
FOLDERS = ("python", "docs", "benches", "examples", "tests/python", "tests/extending")
PAGES = ("README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "noxfile.py", "Cargo.toml", "pyproject.toml")
KINDS = {".py", ".md", ".js", ".wgsl", ".html", ".css", ".rs"}
WORDS = (
    "behaviour", "cancelled", "cancelling", "catalogue", "centre", "centring", "colour", "favour",
    "fibre", "grey", "labelled", "labelling", "licence", "modelled", "modelling", "neighbour",
    "vapour", "metre",
)  # fmt: skip
STEMS = (
    "character", "digit", "general", "initial", "maxim", "minim", "normal", "optim", "parallel",
    "polar", "quant", "raster", "real", "recogn", "regular", "serial", "summar", "vector",
)  # fmt: skip
ENDINGS = ("ise", "ising", "isation")
# Titles of papers, and names that others chose.
KEPT = re.compile(
    r"metamerism and colour constancy|a colour scheme for the display|digitising airborne|cancellederror|"
    r'flat\.centre|bvh/optimise|:optimise|cmap="greys"'
)


def files():
    """Yield the files with code or prose."""
    for folder in FOLDERS:
        yield from (path for path in (ROOT / folder).rglob("*") if path.suffix in KINDS)
    yield from (ROOT / page for page in PAGES)


def comments(text):
    """Return the comments of Rust code, without the code that they quote."""
    found = (line.partition("//") for line in text.splitlines())
    quoted = ("\n".join(after for before, _, after in found if before.count('"') % 2 == 0)).split("`")
    return "".join(quoted[::2])


def british(text):
    """Return the parts of words of a text that are spelled the British way."""
    text = text.lower()
    spelled = [*WORDS, *(stem + ending for stem in STEMS for ending in ENDINGS)]
    if found := [part for part in spelled if part in text]:
        text = KEPT.sub("", text)
        return [part for part in found if part in text]
    return []


def test_words_are_american():
    own = Path(__file__)
    found = {
        path.relative_to(ROOT).as_posix(): words
        for path in files()
        if path != own and "_build" not in path.parts and (words := british(path.read_text(encoding="utf-8")))
    }
    assert found == {}


def test_comments_of_the_crates_are_american():
    found = {}
    for path in (ROOT / "rust").rglob("*.rs"):
        name = path.relative_to(ROOT).as_posix()
        if words := british(comments(path.read_text(encoding="utf-8"))):
            found[name] = words
    assert found == {}


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("the Colour of grey vapour", 3),
        ("two metres; neighbours are normalised, and were optimising", 4),
        ("the color of gray vapor, meters, parameters, symmetries, optimistic realism, checkerboards", 0),
        ("CancelledError is asyncio's", 0),
    ],
)
def test_british_words_are_seen(text, count):
    assert len(british(text)) == count
