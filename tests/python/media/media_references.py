"""How scenes with media look by paths: what the tests of photons and of paths from both ends compare with.

``PYTHONPATH=tests/python/helpers python tests/python/media/media_references.py --write`` renders them by
``rw.Path(guiding="none")``, seed 10**9,
and writes means and standard errors of blocks of pixels to ``data/media_blocks.npz``. Names after it are
those of the scenes to render; the others stay as they are.
"""

import sys
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import numpy as np

import raywright as rw

REFERENCES = Path(__file__).parents[1] / "data" / "media_blocks.npz"


def scenes():
    """Return scene, camera, greatest depth, samples and pixels on the side of a block, by name."""
    import test_media_both_ends as both
    import test_media_photon_maps as maps

    found = {f"maps: {name}": (scene, maps.camera(), None, 4096, 4) for name, scene in maps.SCENES.items()}
    found |= {f"ends: {name}": (scene, both.camera(), None, 1024, 8) for name, scene in both.SCENES.items()}
    within = both.SCENES["lamp within"], both.camera(target=(0, 0, 0.8))
    return found | {f"ends: depth {depth}": (*within, depth, 1024, 8) for depth in (1, 2, 3)}


@cache
def kept(name):
    """Return the stored means and errors of a scene as pixels, block by block."""
    with np.load(REFERENCES) as found:
        mean, error = (found[f"{name}: {what}"] for what in ("mean", "standard error"))
    block = 4 if name.startswith("maps") else 8
    # The error of a mean is that of independent pixels, divided by the side of the block.
    pixels = (np.kron(values, np.ones((block, block, 1))) for values in (mean, block * error))
    return SimpleNamespace(**dict(zip(("rgb", "standard_error"), pixels, strict=True)))


def write(names):
    found = dict(np.load(REFERENCES)) if names and REFERENCES.exists() else {}
    for name, (scene, camera, depth, samples, block) in scenes().items():
        if names and name not in names:
            continue
        path = rw.Path(depth, guiding="none")
        image = rw.render(scene, camera, path, samples, seed=10**9, progress=False)
        many = camera.width // block

        def blocks(values, many=many, block=block):
            return values.astype(float).reshape(many, block, many, block, 3).mean(axis=(1, 3))

        variance = blocks(image.standard_error.astype(float) ** 2) / block**2
        found[f"{name}: mean"] = blocks(image.rgb).astype(np.float32)
        found[f"{name}: standard error"] = np.sqrt(variance).astype(np.float32)
        np.savez_compressed(REFERENCES, **found)
        print(name, flush=True)


if __name__ == "__main__":
    if sys.argv[1:2] != ["--write"]:
        sys.exit(__doc__)
    write(sys.argv[2:])
