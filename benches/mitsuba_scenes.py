"""What raywright says of Mitsuba's published scenes: a folder of them, one line each.

    python benches/mitsuba_scenes.py PATH

PATH is a copy of the repository mitsuba-renderer/mitsuba-data. Every file there whose outermost element is a
scene is read, apart from fragments that others include. With ``--render``, each that loads is rendered at one
sample for 32 by 24 pixels too.
"""

import argparse
import re
import sys
import time
import warnings
from pathlib import Path

import raywright as rw

# What is included by others, or has no sensor by itself.
_PARTS = ("fragments", "include", "common")


def scenes(folder: Path) -> list[Path]:
    """Return the files that hold whole scenes."""
    found = []
    for path in sorted(folder.rglob("*.xml")):
        text = path.read_text(encoding="utf-8", errors="replace")
        whole = re.search(r"<scene\b", text) and ("<sensor" in text or "<include" in text)
        if whole and not any(part in _PARTS for part in path.parts):
            found.append(path)
    return found


def told(path: Path, root: Path, render: bool) -> tuple[bool, str]:
    """Return whether a scene loads, and what is said of it."""
    begin = time.perf_counter()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            # Some say how many samples they take by a parameter alone, or rely on what all share.
            given = {"spp": 4} if "$spp" in path.read_text(encoding="utf-8") else {}
            shot = rw.from_mitsuba(path, folder=root / "common", parameters=given)
            if render:
                shot.resized(32, 24).render(samples=1, progress=False)
        except (ValueError, OSError) as error:
            return False, f"{type(error).__name__}: {error}"
    said = [str(warning.message) for warning in caught]
    return True, f"{time.perf_counter() - begin:.2f} s {'; '.join(said)}"


def main() -> None:
    """Print what is said of each."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("path", type=Path)
    parser.add_argument("--render", action="store_true", help="render each that loads, in small")
    parser.add_argument("--list", type=Path, help="a file that names the scenes, one a line, in place of all")
    asked = parser.parse_args()
    names = (
        scenes(asked.path)
        if asked.list is None
        else [asked.path / line for line in asked.list.read_text().split("\n") if line]
    )
    loaded = 0
    for path in names:
        good, text = told(path, asked.path, asked.render)
        loaded += good
        print(f"{'ok' if good else 'NO':4}{path.relative_to(asked.path)}  {text}", flush=True)
    print(f"{loaded} of {len(names)} load", file=sys.stderr)


if __name__ == "__main__":
    main()
