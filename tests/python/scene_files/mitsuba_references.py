"""What Mitsuba makes of the scenes of `mitsuba_scenes`.

``python tests/python/scene_files/mitsuba_references.py --write``, where Mitsuba 3 is installed, renders them
and writes
the means and standard errors of blocks of pixels to ``data/mitsuba_blocks.npz``, which the tests compare
with. Names after it are those of the scenes to render; the others stay as they are.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np
from mitsuba_files import write_files
from mitsuba_parts import SIZE
from mitsuba_scenes import scenes

REFERENCES = Path(__file__).parents[1] / "data" / "mitsuba_blocks.npz"
BLOCK = 8
SPECTRA = ("spectrum", "regular", "irregular", "blackbody")
# The spread of these independent pictures gives the error of their mean.
SEEDS, SAMPLES = 64, 128


def blocks(pixels):
    """The means of blocks of pixels, (4, 4, 3)."""
    count = SIZE // BLOCK
    return np.asarray(pixels, np.float64).reshape(count, BLOCK, count, BLOCK, 3).mean(axis=(1, 3))


def by_mitsuba(given, folder):
    """Means and standard errors of blocks, by Mitsuba."""
    import mitsuba as mi

    spectral = _is_spectral(given)
    if mi.variant() is None or ("spectral" in mi.variant()) != spectral:
        mi.set_variant("llvm_ad_spectral" if spectral else "llvm_ad_rgb")
    # Mitsuba requires its own objects for transforms.
    loaded = mi.load_dict(_placed(given, mi, folder))
    means = np.stack(
        [blocks(np.array(mi.render(loaded, spp=SAMPLES, seed=seed))[..., :3]) for seed in range(SEEDS)]
    )
    return means.mean(axis=0), means.std(axis=0, ddof=1) / np.sqrt(SEEDS)


def _is_spectral(given):
    """Whether anything of it goes with wavelength."""
    if given.get("type") in SPECTRA:
        return True
    return any(_is_spectral(value) for value in given.values() if isinstance(value, dict))


def _placed(given, mi, folder):
    result = {}
    for key, value in given.items():
        if isinstance(value, dict):
            value = _placed(value, mi, folder)
        elif key in ("to_world", "to_uv"):
            value = mi.ScalarTransform4f(np.array(value))
        elif key == "filename":
            value = str(folder / value)
        result[key] = value
    return result


def write(names):
    """Render scenes by Mitsuba and write the references; all of them if none is named."""
    REFERENCES.parent.mkdir(exist_ok=True)
    kept = dict(np.load(REFERENCES)) if REFERENCES.exists() and names else {}
    with tempfile.TemporaryDirectory() as folder:
        write_files(Path(folder))
        for name, given in scenes().items():
            if not names or name in names:
                mean, error = by_mitsuba(given, Path(folder))
                kept[f"{name}: mean"], kept[f"{name}: standard error"] = mean, error
                np.savez_compressed(REFERENCES, **kept)
                print(f"{name}: {mean.mean():.4g}, to {error.mean() / mean.mean():.1e} of it", flush=True)


if __name__ == "__main__":
    if sys.argv[1:2] != ["--write"]:
        sys.exit(__doc__)
    write(sys.argv[2:])
