"""What README and the pages under docs/ say is so: their Python is run and what they claim is checked.

Blocks of a page are run in order, in one namespace, in an empty folder. A block after ``<!-- shown -->`` is
not: it is for packages that are not installed here. A comment that begins with ``<!-- check`` holds what must
be so after the blocks before it; readers do not see it.
"""

import json
import re
import runpy
from pathlib import Path

import pytest
from PIL import Image as Pillow

import raywright as rw

ROOT = Path(__file__).parents[3]
PAGES = ["README.md", *sorted(f"docs/{path.name}" for path in (ROOT / "docs").glob("*.md"))]

# Sizes on the pages, and smaller ones for tests; checks apply to those.
SMALLER = {
    "docs/pictures.md": {
        "width=160, height=120": "width=40, height=30",
        'value="160"': 'value="40"',
        'value="120"': 'value="30"',
        "resized(width=320)": "resized(width=80)",
        "(120, 160, 3)": "(30, 40, 3)",
        "(240, 320, 3)": "(60, 80, 3)",
        'rw.load("room.glb")\n': 'rw.load("room.glb").resized(width=72)\n',
        "(720, 480)": "(72, 48)",
        "(480, 720, 3)": "(48, 72, 3)",
        "width=96, height=96": "width=48, height=48",
        "(96, 96)": "(48, 48)",
        "width=120, height=90": "width=40, height=30",
        "scene.pick(camera, 60, 70)": "scene.pick(camera, 20, 23)",
        '"width": 120, "height": 90': '"width": 40, "height": 30',
        "(90, 120, 3)": "(30, 40, 3)",
        "(90, 120, 6, 2)": "(30, 40, 6, 2)",
        "ProgressivePhotonMap(20_000)": "ProgressivePhotonMap(4_000)",
        "inside, way, samples=64": "inside, way, samples=16",
    },
    "docs/measuring.md": {"rays=4096": "rays=2048", "1_000_000": "200_000"},
    "docs/media.md": {"ProgressivePhotonMap(20_000)": "ProgressivePhotonMap(4_000)"},
    "README.md": {
        "1_000_000": "10_000",
        "subdivisions=5": "subdivisions=3",
        "width=256, height=256": "width=16, height=16",
        "seconds=20": "seconds=1",
    },
}

BLOCK = re.compile(
    r"^<!-- shown -->\n```python\n.*?^```$"
    r"|^```python\n(?P<code>.*?)^```$"
    r"|^<!-- check\n(?P<check>.*?)^-->$",
    re.MULTILINE | re.DOTALL,
)


def blocks(text):
    """Yield code below so many empty lines that its lines have the numbers of the page."""
    for found in BLOCK.finditer(text):
        name = found.lastgroup
        if name:
            yield "\n" * text.count("\n", 0, found.start(name)) + found[name]


def read(page):
    return (ROOT / page).read_text(encoding="utf-8")


@pytest.mark.parametrize("page", PAGES)
def test_page_is_true(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = read(page)
    for large, small in SMALLER.get(page, {}).items():
        assert large in text, f"{page} has no {large} to make smaller"
        text = text.replace(large, small)
    namespace = {"__name__": "__page__"}
    for code in blocks(text):
        exec(compile(code, ROOT / page, "exec"), namespace)


def test_blocks_are_found_and_keep_their_lines():
    shown = "<!-- shown -->\n```python\nimport open3d\n```\n"
    text = f"a\n```python\nx = 1\n```\n{shown}<!-- check\nassert x\n-->\n"
    found = list(blocks(text))
    assert [code.strip() for code in found] == ["x = 1", "assert x"]
    assert [code.count("\n", 0, code.index(code.strip())) for code in found] == [2, 9]


def test_every_block_of_a_page_is_either_run_or_marked():
    for page in PAGES:
        text = read(page)
        fences = len(re.findall("^```python$", text, re.MULTILINE))
        assert len(re.findall(BLOCK, text)) == fences + text.count("<!-- check\n"), page


@pytest.mark.parametrize(("name", "wide", "most"), [("gallery", 1000, 10**6), ("measured", 800, 40_000)])
def test_gallery_shows_the_lines_that_made_its_pictures(name, wide, most, monkeypatch):
    script = ROOT / "docs" / f"{name}.py"
    if not script.exists():
        pytest.skip("only the repository has the script and its pictures")
    if name == "measured":
        pytest.importorskip("matplotlib")
    monkeypatch.syspath_prepend(str(script.parent))
    gallery = runpy.run_path(str(script))
    record = json.loads((script.parent / name / "record.json").read_text(encoding="utf-8"))
    assert list(record) == list(gallery["PICTURES"])
    page = read(f"docs/{name}.md")
    assert page == gallery["page"](record)
    links = re.findall(rf"\]\(({name}/[^)]+)\)", page)
    assert len(links) == len(record)
    for link in links:
        file = script.parent / link
        with Pillow.open(file) as picture:
            assert picture.width == wide, link
        assert file.stat().st_size <= most, link


def test_pages_name_what_is_there():
    """Whatever pages write as ``rw.name`` or ``rw.measure.name``, in text and in tables too, is public."""
    for page in PAGES:
        text = read(page)
        for name in re.findall(r"\brw((?:\.[A-Za-z]\w*)+)", text):
            there = rw
            for part in name.split(".")[1:]:
                assert hasattr(there, part), f"{page}: rw{name}"
                there = getattr(there, part)
