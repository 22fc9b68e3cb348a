"""The files that the scenes of `mitsuba_scenes` name: pictures, meshes and curves."""

import struct
import zlib

import numpy as np
from PIL import Image


def write_files(folder):
    """Write the files that the scenes name."""
    rng = np.random.default_rng(7)
    Image.fromarray(rng.integers(20, 235, (6, 9, 3), np.uint8)).save(folder / "colors.png")
    y, x = np.meshgrid(*2 * [(np.arange(32) + 0.5) / 32], indexing="ij")
    bumps = 0.5 + 0.5 * np.sin(4 * np.pi * x) * np.sin(2 * np.pi * y)
    Image.fromarray(np.uint8(np.round(255 * bumps))).save(folder / "bumps.png")
    tilted = np.stack([0.3 * np.sin(2 * np.pi * x), 0.3 * np.cos(4 * np.pi * y) * x, np.ones_like(x)], -1)
    tilted /= np.linalg.norm(tilted, axis=-1, keepdims=True)
    Image.fromarray(np.uint8(np.round(127.5 * (tilted + 1)))).save(folder / "normals.png")
    # Radiance's format: three mantissas and the exponent that they share.
    mantissas = rng.integers(30, 256, (8, 16, 3), np.uint8)
    exponents = rng.integers(126, 130, (8, 16, 1), np.uint8)
    rows = np.concatenate([mantissas, exponents], -1).tobytes()
    (folder / "around.hdr").write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n" + rows)
    (folder / "bowl.obj").write_text(bowl())
    (folder / "gem.ply").write_text(gem())
    (folder / "dabs.ply").write_text(dabs())
    (folder / "curve.txt").write_text(curve())
    (folder / "spline.txt").write_text(spline())
    (folder / "gem.serialized").write_bytes(serialized())
    (folder / "puff.vol").write_bytes(volume(rng.random((6, 5, 4, 1)) ** 2))
    (folder / "shades.vol").write_bytes(volume(rng.random((3, 4, 5, 3))))


def volume(numbers):
    """A grid of Mitsuba's, of (Z, Y, X, channels)."""
    z, y, x, channels = numbers.shape
    header = struct.pack("<3sBiiiii6f", b"VOL", 3, 1, x, y, z, channels, 0, 0, 0, 1, 1, 1)
    return header + numbers.astype("<f4").tobytes()


def bowl(around=60, along=24):
    """Part of a sphere as an OBJ, of quadrilaterals with coordinates, smooth, its seam open."""
    lines, faces = [], []
    for i in range(along + 1):
        for j in range(around + 1):
            u, v = j / around, i / along
            polar, turn = np.pi * (0.3 + 0.6 * v), 2 * np.pi * u
            point = (np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), np.cos(polar) + 1)
            lines += ["v {:.6f} {:.6f} {:.6f}".format(*point), f"vt {2 * u:.6f} {v:.6f}"]
    for i in range(along):
        for j in range(around):
            a = i * (around + 1) + j + 1
            corners = (a, a + around + 1, a + around + 2, a + 1)
            faces.append("f " + " ".join(f"{k}/{k}" for k in corners))
    return "\n".join(lines + faces) + "\n"


def gem():
    """An octahedron as a PLY."""
    points = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    faces = [(a, b, c) if (a + b + c) % 2 == 0 else (b, a, c) for a in (0, 1) for b in (2, 3) for c in (4, 5)]
    header = ["ply", "format ascii 1.0", "element vertex 6", *(f"property float {name}" for name in "xyz")]
    header += ["element face 8", "property list uchar int vertex_indices", "end_header"]
    lines = [" ".join(map(str, point)) for point in points] + [f"3 {a} {b} {c}" for a, b, c in faces]
    return "\n".join(header + lines) + "\n"


OCTAHEDRON = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]


def eight():
    """The faces of the octahedron, whose normals point out."""
    return [(a, b, c) if (a + b + c) % 2 == 0 else (b, a, c) for a in (0, 1) for b in (2, 3) for c in (4, 5)]


def dabs():
    """An octahedron as a PLY, with colors of its vertices, and colors and shares of its faces."""
    header = ["ply", "format ascii 1.0", "element vertex 6", *(f"property float {name}" for name in "xyz")]
    header += [f"property float color_{k}" for k in range(3)]
    header += ["element face 8", "property list uchar int vertex_indices"]
    header += [f"property float color_{k}" for k in range(3)] + ["property float share_0", "end_header"]
    rng = np.random.default_rng(4)
    lines = [" ".join(f"{x:.4f}" for x in (*point, *rng.uniform(0.1, 0.9, 3))) for point in OCTAHEDRON]
    lines += [
        f"3 {a} {b} {c} " + " ".join(f"{x:.4f}" for x in rng.uniform(0.1, 0.9, 4)) for a, b, c in eight()
    ]
    return "\n".join(header + lines) + "\n"


def curve():
    """Two curves of points with a radius."""
    one = ["-1.5 0 -0.6 0.2", "-0.8 0.2 0.7 0.25", "0 -0.3 -0.4 0.3", "0.7 0.3 0.6 0.2", "1.4 0 -0.5 0.3"]
    two = ["-1 1 0.9 0.1", "0 1.1 1.1 0.15", "1 0.8 0.8 0.1", "1.5 1 0.6 0.12"]
    return "\n".join([*one, "", *two]) + "\n"


def spline():
    """A curve whose open ends are under the floor, where nobody sees into them."""
    low = [f"{x} 0.2 {z} 0.2" for x, z in ((-1.5, -3), (-1.5, -2), (1.4, -2), (1.4, -3))]
    return "\n".join([*low[:2], *curve().split("\n\n")[0].split("\n"), *low[2:]]) + "\n"


def serialized(version=4, double=True):
    """Two meshes in Mitsuba's own format: a triangle, and an octahedron with coordinates and no normals."""
    kind = "<f8" if double else "<f4"

    def mesh(points, faces):
        points = np.array(points, kind)
        flags = (0x2000 if double else 0x1000) | 0x0002
        parts = struct.pack("<I", flags) + (b"gem\0" if version == 4 else b"")
        parts += struct.pack("<QQ", len(points), len(faces)) + points.tobytes() + points[:, :2].tobytes()
        return struct.pack("<HH", 0x041C, version) + zlib.compress(parts + np.array(faces, "<u4").tobytes())

    meshes = [mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]), mesh(OCTAHEDRON, eight())]
    starts = [0, len(meshes[0])]
    ends = struct.pack("<QQ" if version == 4 else "<II", *starts) + struct.pack("<I", 2)
    return b"".join(meshes) + ends
