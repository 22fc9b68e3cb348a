"""OBJ and MTL files written line by line, so that tests know what is in them."""

import warnings
from pathlib import Path

import numpy as np
from PIL import Image

import raywright as rw

# The square from (0, 0) to (1, 1) in the plane z = 0, whose normal is +z, with coordinates.
SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
FACE = "f 1/1 2/2 3/3 4/4\n"


def write(folder: Path, statements: str, geometry: str = SQUARE, faces: str = FACE, head: str = "") -> Path:
    """Write a mesh of one material, which is given by statements, and return its path."""
    (folder / "file.mtl").write_text(f"{head}newmtl it\n{statements}\n", encoding="utf-8")
    path = folder / "file.obj"
    path.write_text(f"mtllib file.mtl\n{geometry}usemtl it\n{faces}", encoding="utf-8")
    return path


def picture(folder: Path, name: str, pixels: object, kind: type = np.uint8) -> np.ndarray:
    """Write a picture, and return what is in it as (H, W, C)."""
    array = np.asarray(pixels, kind)
    Image.fromarray(array).save(folder / name)
    return array if array.ndim == 3 else array[..., np.newaxis]


def loaded(path: Path, *told: str) -> rw.Mesh:
    """Return the one mesh of a file; what is warned of, once each and here, must be `told`."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        (mesh,) = rw.Scene(path).shapes
    assert [str(one.message) for one in caught] == list(told)
    assert all(one.category is RuntimeWarning and one.filename == __file__ for one in caught)
    return mesh


def material(folder: Path, statements: str, *told: str, head: str = "") -> rw.materials.Material:
    """Return the material of a square that statements tell of."""
    return loaded(write(folder, statements, head=head), *told).material
