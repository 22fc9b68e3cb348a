"""Mesh files and pictures that are cut short, or say that they hold what they do not, are refused."""

import struct
import sys
import zlib

import numpy as np
import pytest
import trimesh
from refusals import Reader

import raywright as rw
from raywright.io.pictures import read

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="limits of memory are Linux's")

BILLION = 10**9
POINTS = np.float32([(0, 0, 0), (1, 0, 0), (0, 1, 0)]).tobytes()
TEXT = b"0 0 0\n1 0 0\n0 1 0\n"
FACE = struct.pack("<Biii", 3, 0, 1, 2)


@pytest.fixture(scope="module")
def reader():
    made = Reader()
    yield made
    made.close()


def ply(kind: str, vertices: int, faces: int, body: bytes) -> bytes:
    axes = "".join(f"property float {axis}\n" for axis in "xyz")
    head = f"ply\nformat {kind} 1.0\nelement vertex {vertices}\n{axes}element face {faces}\n"
    return head.encode() + b"property list uchar int vertex_indices\nend_header\n" + body


def binary(vertices: int, faces: int, body: bytes = POINTS + FACE) -> bytes:
    return ply("binary_little_endian", vertices, faces, body)


def npy(shape: str) -> bytes:
    told = f"{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}".encode().ljust(117)
    return b"\x93NUMPY\x01\x00v\x00" + told + b"\n" + bytes(100)


def hdr(height: int, width: int, body: bytes = bytes(100)) -> bytes:
    return f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode() + body


def exr(width: int, height: int, body: bytes = bytes(100)) -> bytes:
    def attribute(name: bytes, kind: bytes, value: bytes) -> bytes:
        return name + b"\0" + kind + b"\0" + struct.pack("<i", len(value)) + value

    channels = b"".join(name + b"\0" + struct.pack("<iiii", 2, 0, 1, 1) for name in (b"B", b"G", b"R"))
    box = struct.pack("<4i", 0, 0, width - 1, height - 1)
    head = attribute(b"channels", b"chlist", channels + b"\0")
    head += attribute(b"compression", b"compression", b"\3")
    head += attribute(b"dataWindow", b"box2i", box) + attribute(b"displayWindow", b"box2i", box)
    return b"v/1\x01\x02\0\0\0" + head + b"\0" + body


def png(width: int, height: int) -> bytes:
    parts = [b"IHDR" + struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)]
    parts += [b"IDAT" + zlib.compress(bytes(1000)), b"IEND"]
    chunks = [struct.pack(">I", len(one) - 4) + one + struct.pack(">I", zlib.crc32(one)) for one in parts]
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunks)


def tiff(size: int) -> bytes:
    tags = ((256, size), (257, size), (258, 8), (262, 1), (273, 8))
    return (
        b"II*\0\x08\0\0\0\x05\0" + b"".join(struct.pack("<HHII", tag, 4, 1, n) for tag, n in tags) + bytes(4)
    )


MESHES = {
    "vertices.ply": (binary(BILLION, 1), "1000000000 of vertex by its header, and the file has 227 bytes"),
    "faces.ply": (binary(3, BILLION), "1000000000 of face by its header"),
    "fewer.ply": (binary(-3, 1), "'-3' is not a valid count"),
    "digits.ply": (binary(10**400, 1), "is not a valid count"),
    "cut.ply": (binary(3, 1, POINTS + FACE[:-1]), "it is cut short: it has 1 of face by its header"),
    "corners.ply": (
        binary(3, 1, POINTS + b"\xff" + FACE[1:]),
        "it is cut short: it has 1 of face by its header",
    ),
    "index.ply": (binary(3, 1, POINTS + struct.pack("<Biii", 3, 0, 1, 9)), "but there are 3 vertices"),
    "text vertices.ply": (
        ply("ascii", BILLION, 1, TEXT + b"3 0 1 2\n"),
        "it has 1000000000 of vertex by its header, and its body ends after 13 numbers",
    ),
    "text faces.ply": (ply("ascii", 3, BILLION, TEXT + b"3 0 1 2\n"), "1000000000 of face by its header"),
    "text corners.ply": (
        ply("ascii", 3, 1, TEXT + b"999999999 0 1 2\n"),
        "it is cut short: it has 1 of face",
    ),
    "text cut.ply": (ply("ascii", 3, 1, TEXT + b"3 0 1"), "it is cut short: it has 1 of face"),
    "word.ply": (
        ply("ascii", 3, 1, b"0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n"),
        "word 5 of its body is 'x', which is not a number",
    ),
    "type.ply": (binary(3, 1).replace(b"float z", b"complex z"), "property 'z' has type 'complex'"),
    "format.ply": (binary(3, 1).replace(b"binary_little", b"gzip"), "its format is 'gzip_endian'"),
    "lists.ply": (ply("ascii", 3, 2, TEXT + b"3 0 1 2\n-1 0 1 2\n"), "a face has a list of -1 numbers"),
    "half.ply": (ply("ascii", 3, 1, TEXT + b"2.5 0 1 2\n"), "2.5 is not a valid list length"),
    "endless.ply": (b"ply\nformat ascii 1.0\n" + b"comment x" * 10**6, "it has no header of a PLY"),
    "faces.stl": (bytes(80) + struct.pack("<I", BILLION) + bytes(50), "1000000000 faces by its header"),
    "most.stl": (bytes(80) + b"\xff" * 4, "it has 4294967295 faces by its header, and room for 0"),
    "cut.stl": (bytes(80) + struct.pack("<I", 2) + bytes(60), "2 faces by its header, and room for 1"),
    "short.stl": (bytes(50), "it is cut short: an STL has at least 84 bytes, and it has 50"),
    "text.stl": (b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", "1 facets begin and 0 end"),
    "vertices.off": (
        b"OFF\n1000000000 1 0\n" + TEXT + b"3 0 1 2\n",
        "it has 1000000000 of vertex by its header",
    ),
    "faces.off": (b"OFF\n3 1000000000 0\n" + TEXT + b"3 0 1 2\n", "1000000000 of face by its header"),
    "corners.off": (b"OFF 3 1 0\n" + TEXT + b"999999999 0 1 2\n", "it is cut short: it has 1 of face"),
    "index.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 1000000000\n", "out of bounds"),
    "far.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999999999\n", "out of bounds"),
    "cut.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nv 0 1", "vertices must have shape (N, 3)"),
    "no faces.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", "holds no faces"),
}
GIF_REST = bytes(3) + b"," + struct.pack("<HHHH", 0, 0, 65535, 65535) + b"\0\2\0;"
POINTS_OF = "has more than 89478485 points by its header"
PICTURES = {
    "points.png": (png(31623, 31623), POINTS_OF),
    "many.png": (png(12000, 12000), POINTS_OF),
    "most.png": (png(2**31 - 1, 2**31 - 1), POINTS_OF),
    "cut.png": (png(9000, 9000), "truncated"),
    "points.bmp": (
        b"BM" + struct.pack("<IIIIiiHHIIiiII", 54, 0, 54, 40, 31623, 31623, 1, 24, 0, 0, 0, 0, 0, 0),
        POINTS_OF,
    ),
    "points.tif": (tiff(31623), POINTS_OF),
    "points.gif": (b"GIF89a" + struct.pack("<HH", 65535, 65535) + GIF_REST, POINTS_OF),
    "noise.jpg": (bytes(range(256)), "it is not a picture that Pillow knows"),
    "points.exr": (exr(31623, 31623), "it has 31623 x 31623 points by its header, and 134217728 are read"),
    "most.exr": (exr(2**31 - 1, 2**31 - 1), "points by its header"),
    "row.exr": (exr(BILLION, 1), "it has 1000000000 x 1 points by its header"),
    "column.exr": (exr(1, BILLION), "it has 1 x 1000000000 points by its header"),
    "none.exr": (exr(0, 4), "it has 0 x 4 points by its header"),
    "chunks.exr": (exr(9000, 9000), "it is cut short: it has 563 chunks by its header"),
    # A chunk for each 16 rows, all of them the same two bytes.
    "promised.exr": (
        exr(
            16384,
            8192,
            struct.pack("<512Q", *[5000] * 512) + bytes(600) + struct.pack("<ii", 0, 2) + bytes(900),
        ),
        "is in no place of its own|is cut short or broken",
    ),
    "noise.exr": (bytes(range(256)), "it is not an EXR file"),
    "head.exr": (exr(4, 4)[:60], "it is cut short within its header"),
    "points.hdr": (hdr(31623, 31623), "cut short"),
    "rows.hdr": (hdr(BILLION, 0), "cut short"),
    "less.hdr": (hdr(-5, 10), "it is not a Radiance picture"),
    "digits.hdr": (hdr(10**30, 10), "cut short"),
    "run.hdr": (hdr(2, 8, b"\2\2\0\x08" + b"\xff\0" * 40), "cut short"),
    "points.npy": (npy("(31623, 31623, 3)"), "greater than file size"),
    "objects.npy": (npy("(2, 2)").replace(b"<f4", b"|O "), "cannot be read|can be read"),
    "head.npy": (npy("(2, 2)")[:40], "can be read"),
}


@pytest.mark.parametrize("name", MESHES)
def test_meshes_are_refused_in_one_line(tmp_path, reader, name):
    data, message = MESHES[name]
    (tmp_path / name).write_bytes(data)
    assert message in reader.refuse("mesh", tmp_path / name)


@pytest.mark.parametrize("name", PICTURES)
def test_pictures_are_refused_in_one_line(tmp_path, reader, name):
    data, message = PICTURES[name]
    (tmp_path / name).write_bytes(data)
    told = reader.refuse("picture", tmp_path / name)
    assert any(one in told for one in message.split("|"))


@pytest.mark.parametrize("kind", ["ply", "ply_ascii", "stl", "stl_ascii", "off"])
def test_meshes_that_are_cut_anywhere_are_missed(tmp_path, kind):
    """Unless no more than the end of the last line is missing."""
    path = tmp_path / f"box.{kind.removesuffix('_ascii')}"
    box = trimesh.creation.box()
    if kind.startswith("ply"):
        data = box.export(file_type="ply", encoding="ascii" if "ascii" in kind else "binary")
    else:
        data = box.export(file_type=kind)
    data = (data.encode() if isinstance(data, str) else data).rstrip(b"\n")
    path.write_bytes(data)
    assert len(rw.Scene(path).shapes[0].faces) == 12
    # A text number without a digit is still a number, and a shortened name is a name.
    last = data.rfind(b" ") if kind != "stl_ascii" else data.rfind(b"endsolid") + 8
    ends = len(data) if kind in ("ply", "stl") else last
    for length in {*range(0, ends, 37), ends - 1}:
        path.write_bytes(data[:length])
        with pytest.raises(ValueError, match=r"box\.\w+ (is not a mesh that can be read|holds no faces)"):
            rw.Scene(path)


@pytest.mark.parametrize("suffix", [".png", ".exr", ".npy"])
def test_pictures_that_are_cut_anywhere_are_missed(tmp_path, capfd, picture, suffix):
    path = tmp_path / f"picture{suffix}"
    picture.save(path)
    data = path.read_bytes()
    whole = read(path)
    for length in range(len(data)):
        path.write_bytes(data[:length])
        try:
            found = read(path)
        except ValueError:
            continue
        # The end of a PNG holds no pixels: all are there.
        assert suffix == ".png"
        assert length > len(data) - 32
        assert np.array_equal(found, whole)
    # Libraries print nothing.
    assert capfd.readouterr() == ("", "")
