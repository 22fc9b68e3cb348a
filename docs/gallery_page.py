"""The common part of the galleries: a picture is a function, and its page shows the code."""

import inspect
import json
import os
import re
import textwrap
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

Picture = Callable[[], Any]


def lines(picture: Picture) -> str:
    """Return the lines that make a picture: all of its function but the last, which returns it."""
    body = inspect.getsource(picture).split('"""', 2)[2].strip("\n")
    body = textwrap.dedent(body).rsplit("\nreturn ", 1)[0]
    # Definitions at the left margin have two empty lines around them.
    body = re.sub(r"\n\n+(?=def )", "\n\n\n", body)
    return re.sub(r"(\n    .*)\n\n+(?=\S)", r"\1\n\n\n", body)


def page(head: str, pictures: Mapping[str, Picture], record: Mapping[str, str], folder: str) -> str:
    """Return the page of the pictures that are in the record, after its head."""
    parts = [head]
    for name, picture in pictures.items():
        if name in record:
            parts += [f"## {name.capitalize()}\n", f"{inspect.getdoc(picture)}\n"]
            suffix = "png" if f"{name}.png" in lines(picture) else "jpg"
            parts += [f"![{name}]({folder}/{name}.{suffix})\n", f"{record[name]}.\n"]
            parts += [f"<!-- shown -->\n```python\n{lines(picture)}\n```\n"]
    return "\n".join(parts)


def make(
    names: list[str],
    pictures: Mapping[str, Picture],
    folder: Path,
    told: Callable[[str, Any, float], str],
) -> dict[str, str]:
    """Make the pictures of these names, or all, in a folder, and return its record.

    `told` is given the name, what the function returned, and the seconds of the processor that it took.
    """
    unknown = set(names) - set(pictures)
    if unknown:
        raise SystemExit(f"no such picture: {', '.join(sorted(unknown))}; there are {', '.join(pictures)}")
    folder.mkdir(exist_ok=True)
    os.chdir(folder)
    kept = Path("record.json")
    for name in names or pictures:
        start = time.process_time()
        made = pictures[name]()
        line = told(name, made, time.process_time() - start)
        print(f"{name}: {line}", flush=True)
        record = json.loads(kept.read_text()) if kept.exists() else {}
        record[name] = line
        kept.write_text(json.dumps({key: record[key] for key in pictures if key in record}, indent=1) + "\n")
    found: dict[str, str] = json.loads(kept.read_text())
    return found
