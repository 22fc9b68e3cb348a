"""OpenVDB's files in ``data``, and what is in them.

``python tests/python/media/vdb_files.py --write``, where OpenVDB's own Python module is installed (Debian's
``python3-openvdb`` with numpy 1, or conda-forge's ``openvdb``), writes them anew.
"""

import sys
from pathlib import Path

import numpy as np

FOLDER = Path(__file__).parents[1] / "data"
# Compressed by Blosc; two grids, some with a tile of 8³, with a scale and a translation.
SMOKE = FOLDER / "smoke.vdb"
SCALE, MOVED = 0.25, (1.0, -2.0, 3.0)
# In half precision, rotated and sheared, of a single leaf; and beside it a grid that is no float.
HALF = FOLDER / "half.vdb"
TURNED = np.array([[0.0, -0.5, 0.0, 1.0], [0.25, 0.0, 0.0, 2.0], [0.0, 0.125, 1.0, 3.0], [0, 0, 0, 1]])
# Corners and sizes of the grids of smoke.
LOW, SIZE = (-5, 0, 6), (16, 11, 10)
HOT_LOW, HOT_SIZE = (-3, 2, 4), (4, 5, 20)
TILE, TILED = (8, 16, 8), 0.75


def density():
    """The density from (-5, 0, 6) on; 0 in many places."""
    x, y, z = np.indices(SIZE)
    return np.where((x + y + z) % 3 == 0, 0, (1 + x + 20 * y + 300 * z) / 4).astype(np.float32)


def temperature():
    """The temperature from (-3, 2, 4) on."""
    x, y, z = np.indices(HOT_SIZE)
    return (600 + 100 * x + 10 * y + z).astype(np.float32)


def small():
    """What half precision holds."""
    x, y, z = np.indices((3, 4, 5))
    return ((x + 4 * y + 16 * z + 1) / 8).astype(np.float32)


def write(vdb):
    """Write the files by OpenVDB's module."""

    def grid(name, numbers, low, place):
        made = vdb.FloatGrid()
        made.copyFromArray(numbers, ijk=low)
        made.name, made.transform = name, place
        return made

    place = vdb.createLinearTransform(SCALE)
    place.translate(MOVED)
    smoke = grid("density", density(), LOW, place)
    smoke.fill(TILE, tuple(n + 7 for n in TILE), TILED)
    vdb.write(str(SMOKE), grids=[grid("temperature", temperature(), HOT_LOW, place), smoke])
    turned = vdb.createLinearTransform(TURNED.T.tolist())
    half = grid("density", small(), (1, 2, 3), turned)
    half.saveFloatAsHalf = True
    wind = vdb.Vec3SGrid()
    wind.name = "wind"
    wind.fill((0, 0, 0), (3, 3, 3), (1.0, 2.0, 3.0))
    around = vdb.FloatGrid(2.0)
    around.name = "around"
    elsewhere = grid("elsewhere", small(), (1, 2, 3), place)
    vdb.write(str(HALF), grids=[half, wind, around, elsewhere])


if __name__ == "__main__":
    if sys.argv[1:] != ["--write"]:
        sys.exit(__doc__)
    try:
        import openvdb
    except ImportError:
        import pyopenvdb as openvdb
    write(openvdb)
