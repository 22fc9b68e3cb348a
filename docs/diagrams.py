"""A Sphinx extension that draws Mermaid's sequence and block diagrams as SVG, so that pages need no script.

Two kinds of diagrams are read, as far as the pages use them:

- ``sequenceDiagram`` with ``participant A as Name``, ``A->>B: text``, ``B-->>A: text``,
  ``Note over A,B: text``, and ``loop text`` with ``end``;
- ``block-beta`` with ``columns N`` and blocks ``id["text"]`` or ``id["text"]:span``.

GitHub draws the same text by itself.
"""

import re
from html import escape
from typing import Any, NamedTuple

_STYLE = 'font-family="sans-serif" font-size="13" fill="currentColor"'
_LINE = 'stroke="currentColor" fill="none"'
_COLUMN, _ROW, _HEAD = 150, 40, 34


class _Step(NamedTuple):
    """A row of a sequence diagram: a message, a note, or the start or end of a loop."""

    kind: str
    first: int
    last: int
    text: str


def svg(text: str) -> str:
    """Return the drawing of a diagram.

    Raises
    ------
    ValueError
        If a line of it is not understood.
    """
    first, *lines = [line.strip() for line in text.strip().splitlines() if line.strip()]
    drawn = {"sequenceDiagram": _sequence, "block-beta": _blocks}.get(first)
    if drawn is None:
        raise ValueError(f"a diagram must be a sequenceDiagram or block-beta, got {first!r}")
    width, height, parts = drawn(lines)
    size = f'viewBox="0 0 {width} {height}" style="max-width: {width}px; width: 100%"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size}>\n' + "\n".join(parts) + "\n</svg>"


def _label(x: float, y: float, text: str, anchor: str = "middle") -> str:
    shown = escape(text, quote=False)
    return f'<text x="{x:g}" y="{y:g}" text-anchor="{anchor}" {_STYLE}>{shown}</text>'


def _box(x: float, y: float, width: float, height: float, extra: str = "") -> str:
    return f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}" rx="4" {_LINE}{extra}/>'


def _steps(lines: list[str]) -> tuple[list[str], list[_Step]]:
    """Return the names of the participants, and the rows below them."""
    numbers: dict[str, int] = {}
    names: list[str] = []
    steps = []
    for line in lines:
        if found := re.fullmatch(r"participant (\w+)(?: as (.+))?", line):
            numbers[found[1]] = len(names)
            names.append(found[2] or found[1])
        elif found := re.fullmatch(r"(\w+)(--?)>>(\w+): (.+)", line):
            kind = "answer" if found[2] == "--" else "call"
            steps.append(_Step(kind, numbers[found[1]], numbers[found[3]], found[4]))
        elif found := re.fullmatch(r"Note over (\w+)(?:,(\w+))?: (.+)", line):
            steps.append(_Step("note", numbers[found[1]], numbers[found[2] or found[1]], found[3]))
        elif found := re.fullmatch(r"loop (.+)", line):
            steps.append(_Step("loop", 0, 0, found[1]))
        elif line == "end":
            steps.append(_Step("end", 0, 0, ""))
        else:
            raise ValueError(f"a sequence diagram has a line that is not understood: {line!r}")
    return names, steps


def _sequence(lines: list[str]) -> tuple[float, float, list[str]]:
    """Return width, height and elements of a sequence diagram."""
    names, steps = _steps(lines)
    # Columns are as wide as the widest text over them, at some 7 pixels a letter.
    wanted = [
        (7.2 * len(step.text) + 24) / max(1, abs(step.last - step.first)) for step in steps if step.text
    ]
    column = max([_COLUMN, *wanted, *(7.5 * len(name) + 24 for name in names)])
    width, y = column * len(names), _HEAD + 20.0
    middles = [column * (number + 0.5) for number in range(len(names))]
    parts, opened = [], []
    for kind, first, last, text in steps:
        left, right = sorted((middles[first], middles[last]))
        if kind == "note":
            parts.append(_box(left - column * 0.45, y - 4, right - left + column * 0.9, 26, ' opacity="0.6"'))
            parts.append(_label((left + right) / 2, y + 13, text))
        elif kind == "loop":
            opened.append((y, text))
        elif kind == "end":
            top, text = opened.pop()
            parts.append(_box(4, top, width - 8, y - top - 8, ' stroke-dasharray="2 4"'))
            parts.append(_label(12, top + 16, text, "start"))
            y += 8 - _ROW
        else:
            parts += _arrow(middles[first], middles[last], y + 20, text, column, kind == "answer")
        y += _ROW
    lifelines = [f'<path d="M{x:g} {_HEAD + 4}V{y:g}" {_LINE} opacity="0.35"/>' for x in middles]
    heads = [_box(x - column * 0.46, 4, column * 0.92, _HEAD - 4) for x in middles]
    heads += [_label(x, 24, name) for x, name in zip(middles, names, strict=True)]
    return width, y + 8, lifelines + heads + parts


def _arrow(start: float, end: float, y: float, text: str, column: float, is_answer: bool) -> list[str]:
    """Return a line with a head and its text; a message of a participant to itself turns back."""
    dashes = ' stroke-dasharray="5 4"' if is_answer else ""
    if start == end:
        way = f"M{start:g} {y - 2:g}h22v10h-16"
        head = f"M{start + 12:g} {y + 4:g}l-6 4l6 4"
        middle = start
    else:
        towards = 8 if end > start else -8
        way = f"M{start:g} {y:g}H{end:g}"
        head = f"M{end - towards:g} {y - 4:g}L{end:g} {y:g}L{end - towards:g} {y + 4:g}"
        middle = (start + end) / 2
    return [
        f'<path d="{way}" {_LINE}{dashes}/>',
        f'<path d="{head}" {_LINE}/>',
        _label(middle, y - 7, text),
    ]


def _blocks(lines: list[str]) -> tuple[float, float, list[str]]:
    """Return width, height and elements of a diagram of blocks in rows."""
    columns, x, row, parts = 1, 0, 0, []
    cell, high = 360, 46
    for line in lines:
        if found := re.fullmatch(r"columns (\d+)", line):
            columns = int(found[1])
            cell = 720 // columns
            continue
        found = re.fullmatch(r'\w+\["(.+?)"\](?::(\d+))?', line)
        if not found:
            raise ValueError(f"a block diagram has a line that is not understood: {line!r}")
        span = int(found[2] or 1)
        left, top = x * cell + 4, row * (high + 8) + 4
        parts.append(_box(left, top, span * cell - 8, high))
        texts = found[1].split("<br/>")
        for number, text in enumerate(texts):
            parts.append(
                _label(left + span * cell / 2 - 4, top + 28 + 17 * (number - (len(texts) - 1) / 2), text)
            )
        x += span
        if x >= columns:
            x, row = 0, row + 1
    return columns * cell, row * (high + 8) + 8, parts


def setup(app: Any) -> dict[str, bool]:
    """Register the directive ``mermaid``, as Sphinx asks extensions to."""
    from docutils import nodes
    from sphinx.util.docutils import SphinxDirective

    class Diagram(SphinxDirective):
        """A diagram in Mermaid's notation."""

        has_content = True

        def run(self) -> list[Any]:
            """Return the drawing."""
            return [nodes.raw("", svg("\n".join(self.content)), format="html")]

    app.add_directive("mermaid", Diagram)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
