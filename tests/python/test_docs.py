"""What the pages under docs/ say is so: their Python is run, page by page, and what they claim is checked.

Blocks of a page are run in order, in one namespace, in an empty folder. A block after ``<!-- shown -->`` is
not: it is for packages that are not installed here. A comment that begins with ``<!-- check`` holds what must
be so after the blocks before it; readers do not see it.
"""

import re
from pathlib import Path

import pytest

import raywright as rw

DOCS = Path(__file__).parents[2] / "docs"
PAGES = sorted(path.name for path in DOCS.glob("*.md"))
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


@pytest.mark.skipif(not PAGES, reason="the pages are not here")
@pytest.mark.parametrize("page", PAGES)
def test_page_is_true(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    namespace = {"__name__": "__page__"}
    for code in blocks((DOCS / page).read_text(encoding="utf-8")):
        exec(compile(code, DOCS / page, "exec"), namespace)


def test_blocks_are_found_and_keep_their_lines():
    shown = "<!-- shown -->\n```python\nimport open3d\n```\n"
    text = f"a\n```python\nx = 1\n```\n{shown}<!-- check\nassert x\n-->\n"
    found = list(blocks(text))
    assert [code.strip() for code in found] == ["x = 1", "assert x"]
    assert [code.count("\n", 0, code.index(code.strip())) for code in found] == [2, 9]


def test_every_block_of_a_page_is_either_run_or_marked():
    for page in PAGES:
        text = (DOCS / page).read_text(encoding="utf-8")
        fences = len(re.findall("^```python$", text, re.MULTILINE))
        assert len(re.findall(BLOCK, text)) == fences + text.count("<!-- check\n"), page


def test_pages_name_what_is_there():
    """Whatever pages write as ``rw.name``, in text and in tables too, is public."""
    for page in PAGES:
        text = (DOCS / page).read_text(encoding="utf-8")
        for name in re.findall(r"\brw\.(\w+)", text):
            assert hasattr(rw, name), f"{page}: rw.{name}"
