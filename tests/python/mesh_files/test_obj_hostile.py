"""Files of materials that are broken, or meant to do harm: what is left out is told, and the rest shown."""

import warnings

import numpy as np
import pytest
from obj_files import FACE, SQUARE, picture, write

import raywright as rw

NUMBERS = [
    "nan",
    "inf",
    "-1",
    "1e999",
    "1e38",
    "1e-300",
    "",
    "x",
    "0x10",
    "1_0",
    "\ufffd",
    "-" * 500,
    "9" * 5000,
]
KEYWORDS = ["Kd", "Ks", "Ke", "Ns", "Ni", "d", "Tr", "Tf", "illum", "Pr", "Pm", "map_Kd -s", "bump -bm"]
CASES = [
    *(
        f"{base}\n{keyword} {n}{more}"
        for n in NUMBERS
        for keyword in KEYWORDS
        for base, more in (
            ("Kd 0.5 0.5 0.5\nKs 0.5 0.5 0.5\nNs 10\nillum 2", ""),
            ("illum 7\nNi 1.5\nPr 0.5", f" {n} {n}"),
        )
    ),
    *(f"Kd 1 1 1\nKs 1 1 1\nNi {n}\nNs {n}\nKe {n} {n} {n}\nillum {i}" for n in NUMBERS for i in range(11)),
    "newmtl it\n" * 1000,
    "\\\n" * 1000,
    "\0" * 1000,
    "map_Kd " + "a/" * 5000,
    "map_Kd \0",
    "map_Kd -s -o -bm -clamp",
    "map_Kd -s",
    "\n".join(f"k{i} 1" for i in range(10_000)),
]


def test_hostile_materials_are_shown_somehow(tmp_path):
    """Each is read, with few short warnings, and nothing that is no light comes of it."""
    picture(tmp_path, "a.png", np.full((4, 4, 3), 200))
    shapes = []
    for i, statements in enumerate(CASES):
        path = write(tmp_path, statements, faces=FACE)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            (mesh,) = rw.Scene(path).shapes
        assert len(caught) <= 5
        assert all(len(str(one.message)) < 1000 and "\n" not in str(one.message) for one in caught)
        shapes.append(mesh.transformed([(1, 0, 0, i % 20), (0, 1, 0, i // 20), (0, 0, 1, 0), (0, 0, 0, 1)]))
    camera = rw.Camera((10, 10, 30), (10, 10, 0), fov=60, width=60, height=60)
    image = rw.render(rw.Scene(shapes, environment=1.0), camera, samples=8, progress=False)
    assert not image.warnings or all("few samples" in one for one in image.warnings)
    assert np.isfinite(image.rgb).all()
    assert (image.rgb >= 0).all()


@pytest.mark.parametrize(
    "data",
    [
        np.random.default_rng(3).bytes(100_000),
        b"newmtl it\n" + np.random.default_rng(4).bytes(100_000),
        b"newmtl it\n" + b"Kd 0.5 0.5 0.5\n" * 200_000,
        b"".join(b"newmtl m%d\nKd 1 0 0\n" % i for i in range(10**5)),
        b"newmtl it\n" + b"".join(b"k%d 1\n" % i for i in range(10**5)),
        b"newmtl it\nmap_Kd " + b"-s 1 " * 10**5 + b"a.png\n",
        b" " * 10**7,
        b"newmtl it" + b" x" * 10**6,
        "newmtl it\nKd 1 0 0\n".encode("utf-16"),
        b"",
    ],
    ids=[
        "noise",
        "noise within",
        "lines",
        "materials",
        "keywords",
        "options",
        "blanks",
        "name",
        "UTF-16",
        "empty",
    ],
)
def test_hostile_files_of_materials_do_no_harm(tmp_path, data):
    path = write(tmp_path, "")
    (tmp_path / "file.mtl").write_bytes(data)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        (mesh,) = rw.Scene(path).shapes
    assert len(mesh.faces) == 2
    assert len(caught) <= 4
    assert all(len(str(one.message)) < 1000 and "\n" not in str(one.message) for one in caught)


def test_many_files_of_materials_are_not_all_looked_for(tmp_path):
    lines = "".join(f"mtllib {i}.mtl {i}b.mtl\n" for i in range(100_000))
    (tmp_path / "file.obj").write_text(lines + SQUARE + FACE)
    with pytest.warns(
        RuntimeWarning, match=r"^file.obj: files of materials are left out: '0.mtl' .* and \d+ more$"
    ):
        assert len(rw.Scene(tmp_path / "file.obj").shapes) == 1
