"""Tables that notebooks show."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

# Rows shown of a long table.
FEW = 10


def html_table(
    title: str, headings: Sequence[str], rows: Iterable[Sequence[Any]], notes: Sequence[str] = ()
) -> str:
    """Return a table in HTML, with a title above and notes below it; without headings it has none."""
    names = "".join(f"<th>{escape(name)}</th>" for name in headings)
    head = f"<thead><tr>{names}</tr></thead>" if headings else ""
    body = "".join(f"<tr>{''.join(map(_cell, row))}</tr>" for row in rows)
    below = "".join(f"<p>{escape(note)}</p>" for note in notes)
    return f"<div><p><b>{escape(title)}</b></p><table>{head}<tbody>{body}</tbody></table>{below}</div>"


def html_columns(title: str, columns: Mapping[str, Any], size: int) -> str:
    """Return columns of numbers as a table in HTML, `size` rows in all."""
    rows = list(zip(*columns.values(), strict=True))
    notes = [f"{len(rows):,} of {size:,} rows"] if size > len(rows) else []
    return html_table(title, list(columns), rows, notes)


def escape(text: str) -> str:
    """Return a text as in HTML; the standard library's, which takes long to import, does the same."""
    for sign, name in (("&", "amp"), ("<", "lt"), (">", "gt"), ('"', "quot"), ("'", "#x27")):
        text = text.replace(sign, f"&{name};")
    return text


def _cell(value: Any) -> str:
    if isinstance(value, str):
        return f"<td style='text-align: left'>{escape(value)}</td>"
    text = format(value, ".6g") if isinstance(value, float | np.floating) else str(value)
    return f"<td>{escape(text)}</td>"
