"""What raywright says of Mitsuba's published scenes: a folder of them, one line each.

    python benches/mitsuba_scenes.py PATH

PATH is a copy of the repository mitsuba-renderer/mitsuba-data, or a folder in it. Every file there whose
outermost element is a scene is read, apart from fragments that others include. With ``--render``, each that
loads is rendered at one sample for 32 by 24 pixels too. With ``--compare SAMPLES``, where Mitsuba 3 is
installed, it is rendered by both, of 64 by 64 pixels, and the means of 8 by 8 blocks are compared, by the
standard errors of both; by wavelength where raywright does so too. Mitsuba wants LLVM: name Debian's libLLVM
in DRJIT_LIBLLVM_PATH.
"""

import argparse
import re
import sys
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np

import raywright as rw

# Files for inclusion, or without a sensor.
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


# Side in pixels of compared pictures, and of their blocks; number of pictures in each mean.
SIDE, BLOCK, SEEDS = 64, 8, 16
_SIZES = re.compile(r'(name="(?:width|height|res|resx|resy)"\s+value=")\d+"')


def small(folder: Path, into: Path) -> Path:
    """Return a copy of a folder in which all films are small, and all that is no XML is a link.

    A camera that is told of another size later may see something else, by what its angle is measured along.
    """
    for path in sorted(folder.rglob("*")):
        copy = into / path.relative_to(folder)
        if path.is_dir():
            copy.mkdir(exist_ok=True)
        elif path.suffix == ".xml":
            text = path.read_text(encoding="utf-8", errors="replace")
            copy.write_text(_SIZES.sub(rf'\g<1>{SIDE}"', text), encoding="utf-8")
        else:
            copy.symlink_to(path.resolve())
    return into


def blocks(pixels: np.ndarray) -> np.ndarray:
    """Return the means of blocks of pixels."""
    count = SIDE // BLOCK
    cut = np.asarray(pixels, float)[..., :3].reshape(count, BLOCK, count, BLOCK, 3)
    return cut.mean(axis=(1, 3))


def compared(path: Path, shot: rw.rendering.RenderSetup, given: dict[str, int], samples: int) -> str:
    """Return how far apart a scene's pictures by Mitsuba and by raywright are, of as many samples."""
    import mitsuba as mi

    variant = "llvm_ad_rgb" if shot.scene.wavelengths is None else "llvm_ad_spectral"
    if mi.variant() != variant:
        mi.set_variant(variant)
    each = max(1, samples // SEEDS)
    try:
        scene = mi.load_file(str(path), **{name: str(value) for name, value in given.items()})
        theirs = np.stack([blocks(mi.render(scene, spp=each, seed=seed)) for seed in range(SEEDS)])
    except RuntimeError as error:
        return f"Mitsuba: {str(error).splitlines()[-1][-200:]}"
    # The error is the spread of independent pictures: the filter makes pixels dependent.
    ours = np.stack(
        [blocks(shot.render(samples=each, progress=False, seed=seed).rgb) for seed in range(SEEDS)]
    )
    error = np.hypot(theirs.std(axis=0, ddof=1), ours.std(axis=0, ddof=1)) / SEEDS**0.5
    mean, own = theirs.mean(axis=0), ours.mean(axis=0)
    # Mitsuba's sums in single precision err by some 1e-5.
    off = np.abs(own - mean) / (error + 1e-5 / 4 * mean + 1e-12)
    # Spectral variants convert colors by other curves.
    apart = off > 4
    if variant != "llvm_ad_rgb":
        apart &= np.abs(own - mean) > 0.02 * mean
    return (
        f"{'APART' if apart.any() else 'same'}, {variant}: {off.max():.1f} standard errors at most, "
        f"{np.sqrt((off**2).mean()):.2f} in all, of {error.mean() / mean.mean():.1%}; "
        f"{own.mean() / mean.mean() - 1:+.2%} in the mean"
    )


def told(path: Path, root: Path, render: bool, compare: int | None) -> tuple[bool, str]:
    """Return whether a scene loads, and what is said of it."""
    begin = time.perf_counter()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            # Some take their number of samples from a parameter, or rely on the default.
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
    with tempfile.TemporaryDirectory() as folder:
        root = asked.path if asked.compare is None else small(asked.path, Path(folder))
        loaded = 0
        for path in names:
            name = path.relative_to(asked.path)
            good, text = told(root / name, root, asked.render, asked.compare)
            loaded += good
            print(f"{'ok' if good else 'NO':4}{name}  {text}", flush=True)
    print(f"{loaded} of {len(names)} load", file=sys.stderr)


if __name__ == "__main__":
    main()
