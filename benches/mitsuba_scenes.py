"""What raywright says of Mitsuba's published scenes: a folder of them, one line each.

    python benches/mitsuba_scenes.py PATH

PATH is a copy of the repository mitsuba-renderer/mitsuba-data, or a folder in it. Every file there whose
outermost element is a scene is read, apart from fragments that others include. With ``--render``, each that
loads is rendered at one sample for 32 by 24 pixels too. With ``--compare SAMPLES``, where Mitsuba 3 is
installed, it is rendered by both, of 64 by 64 pixels, and the means of 8 by 8 blocks are compared, by the
standard errors of both. Mitsuba wants LLVM: name Debian's libLLVM in DRJIT_LIBLLVM_PATH.
"""

import argparse
import re
import sys
import time
import warnings
from pathlib import Path

import numpy as np

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


# Pixels on a side of the pictures that are compared, and of their blocks; of how many pictures Mitsuba's is.
SIDE, BLOCK, SEEDS = 64, 8, 16


def blocks(pixels: np.ndarray) -> np.ndarray:
    """Return the means of blocks of pixels."""
    count = SIDE // BLOCK
    cut = np.asarray(pixels, float)[..., :3].reshape(count, BLOCK, count, BLOCK, 3)
    return cut.mean(axis=(1, 3))


def compared(path: Path, shot: rw.Shot, given: dict[str, int], samples: int) -> str:
    """Return how far apart a scene's pictures by Mitsuba and by raywright are, of as many samples."""
    import mitsuba as mi

    if mi.variant() is None:
        mi.set_variant("llvm_ad_rgb")
    scene = mi.load_file(str(path), **{name: str(value) for name, value in given.items()})
    film = mi.traverse(scene)
    size = next(key for key in film.keys() if key.endswith("film.size"))  # noqa: SIM118
    film[size] = [SIDE, SIDE]
    film.update()
    theirs = np.stack(
        [blocks(mi.render(scene, spp=max(1, samples // SEEDS), seed=seed)) for seed in range(SEEDS)]
    )
    ours = shot.resized(SIDE, SIDE).render(samples=samples, progress=False)
    error = np.hypot(
        np.sqrt(blocks(ours.standard_error.astype(float) ** 2)) / BLOCK,
        theirs.std(axis=0, ddof=1) / SEEDS**0.5,
    )
    # Mitsuba's single precision adds up to some 1e-5.
    mean = theirs.mean(axis=0)
    off = (blocks(ours.rgb) - mean) / (error + 1e-5 / 4 * mean + 1e-12)
    return (
        f"{np.abs(off).max():.1f} standard errors at most, {np.sqrt((off**2).mean()):.2f} in all, "
        f"of {error.mean() / mean.mean():.1%}; {blocks(ours.rgb).mean() / mean.mean() - 1:+.2%} in the mean"
    )


def told(path: Path, root: Path, render: bool, compare: int | None) -> tuple[bool, str]:
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
            beside = "" if compare is None else compared(path, shot, given, compare)
        except (ValueError, OSError) as error:
            return False, f"{type(error).__name__}: {error}"
    said = [str(warning.message) for warning in caught]
    return True, " ".join([f"{time.perf_counter() - begin:.2f} s", beside, "; ".join(said)])


def main() -> None:
    """Print what is said of each."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("path", type=Path)
    parser.add_argument("--render", action="store_true", help="render each that loads, in small")
    parser.add_argument("--compare", type=int, metavar="SAMPLES", help="with what Mitsuba makes of it")
    parser.add_argument("--list", type=Path, help="a file that names the scenes, one a line, in place of all")
    asked = parser.parse_args()
    names = (
        scenes(asked.path)
        if asked.list is None
        else [asked.path / line for line in asked.list.read_text().split("\n") if line]
    )
    loaded = 0
    for path in names:
        good, text = told(path, asked.path, asked.render, asked.compare)
        loaded += good
        print(f"{'ok' if good else 'NO':4}{path.relative_to(asked.path)}  {text}", flush=True)
    print(f"{loaded} of {len(names)} load", file=sys.stderr)


if __name__ == "__main__":
    main()
