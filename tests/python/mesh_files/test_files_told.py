"""What is wrong with a file is told with its name, in words of the file, and without warnings of numpy."""

import contextlib
import json
import re
import struct
import warnings

import numpy as np
import pytest
from gltf_writer import SQUARE, Writer

import raywright as rw


def glb(length, *chunks):
    body = b"".join(struct.pack("<I4s", len(data), kind) + data for kind, data in chunks)
    return (b"glTF" + struct.pack("<II", 2, length or 12 + len(body)) + body).ljust(20, b"\0")


PLY = (
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
)
XML = '<scene version="3.0.0">{}</scene>'
MESH = (
    '#usda 1.0\ndef Mesh "m" {{\n int[] faceVertexCounts = [3]\n int[] faceVertexIndices = [0, 1, 2]\n'
    " point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]\n {}\n}}\n"
)
TOLD = {
    "header.glb": (glb(12), "it has no chunk of JSON"),
    "binary.glb": (glb(0, (b"BIN\0", bytes(8))), "its first chunk must be JSON"),
    "empty.glb": (glb(0, (b"JSON", b"")), "its JSON is broken at character 0"),
    "no faces.gltf": (json.dumps({"asset": {"version": "2.0"}}).encode(), "it holds no faces"),
    "nan.ply": (PLY.encode() + b"nan 0 0 nan 0 0 nan 0 0 3 0 1 2\n", "there are no faces to show"),
    "nan.obj": (b"v nan 0 0\nv nan 0 0\nv nan 0 0\nf 1 2 3\n", "there are no faces to show"),
    "far.off": (b"OFF 3 1 0\n1e300 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "a coordinate is 1e+300, and up to 1e+150"),
    "scene.xml": (XML.format('<shape type="sphere"/>').encode(), "it has no sensor"),
}


@pytest.mark.parametrize("name", TOLD)
def test_what_is_wrong_is_told_with_the_name_of_the_file(tmp_path, name):
    data, message = TOLD[name]
    (tmp_path / name).write_bytes(data)
    with pytest.raises(ValueError, match=re.escape(message)) as caught:
        rw.load(tmp_path / name)
    told = str(caught.value)
    assert str(tmp_path / name) in told
    assert "\n" not in told


@pytest.mark.parametrize(
    "comment",
    [
        "<!-- a -- b -->",
        "<!---->",
        "<!-- -->",
        "<!----- a ----->",
        "<!-- <a -- b='--'/> -->",
        "<!--\n--\n-->",
    ],
)
def test_comments_of_mitsuba_may_have_dashes(tmp_path, comment):
    parts = '<sensor type="perspective"/><shape type="sphere"/><emitter type="constant"/>'
    path = tmp_path / "a.xml"
    path.write_text(comment.join(["", XML.format(comment + parts + comment)]))
    assert len(rw.load(path).scene.shapes) == 1
    # Line numbers continue.
    path.write_text(XML.format(f"{comment}\n<shape type='sphere' wrong='1'><nothing/></shape>"))
    with pytest.raises(ValueError, match=rf"line {2 + comment.count(chr(10))}"):
        rw.load(path)
    path.write_text(XML.format(parts + "<!-- open -- "))
    with pytest.raises(ValueError, match="not XML that can be read"):
        rw.load(path)


@pytest.mark.parametrize("value", ["nan", "inf", "-inf", "1e300", "1e160", "1e-320"])
@pytest.mark.parametrize("suffix", ["ply", "obj", "pbrt", "xml", "usda"])
def test_numbers_of_files_lead_to_no_warnings_of_numpy(tmp_path, value, suffix):
    if suffix == "usda":
        pytest.importorskip("pxr")
    names = ["x", "y", "z", "nx", "ny", "nz", "u", "v", "red", "green", "blue"]
    head = PLY.replace("".join(f"property float {axis}\n" for axis in "xyz"), "")
    head = head.replace("vertex 3\n", "vertex 3\n" + "".join(f"property double {name}\n" for name in names))
    for first, last in ((0, 3), (3, 6), (6, 8), (8, 11)):
        words = ["0", "0", "0", "0", "0", "1", "0", "0", "1", "0", "0"]
        words[first:last] = [value] * (last - first)
        row = " ".join(words)
        (tmp_path / "a.ply").write_text(
            f"{head}{row}\n1 0 0 0 0 1 1 0 0 1 0\n0 1 0 0 0 1 0 1 0 0 1\n3 0 1 2\n"
        )
        point, normal, uv = (", ".join(words[a:b]) for a, b in ((0, 3), (3, 6), (6, 8)))
        (tmp_path / "a.obj").write_text(
            f"v {point.replace(',', '')}\nv 1 0 0\nv 0 1 0\nvt {uv.replace(',', '')}\n"
            f"vn {normal.replace(',', '')}\nf 1/1/1 2/1/1 3/1/1\n"
        )
        (tmp_path / "a.pbrt").write_text(
            'Camera "perspective"\nWorldBegin\nScale 2 2 2\nShape "plymesh" "string filename" "a.ply"\n'
        )
        ply = '<shape type="ply"><string name="filename" value="a.ply"/></shape>'
        (tmp_path / "a.xml").write_text(XML.format(f'<sensor type="perspective"/>{ply}'))
        moved = 'double3 xformOp:scale = (2, 2, 2)\n uniform token[] xformOpOrder = ["xformOp:scale"]'
        shown = MESH.format(f"normal3f[] normals = [({normal}), (0, 0, 1), (0, 0, 1)]\n {moved}")
        (tmp_path / "a.usda").write_text(shown.replace("[(0, 0, 0)", f"[({point})"))
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            with contextlib.suppress(ValueError):
                rw.load(tmp_path / f"a.{suffix}").scene.intersect((0, 0, 1), (0, 0, -1))
        assert not [str(one.message) for one in caught if "encountered" in str(one.message)]


def test_numbers_of_gltf_lead_to_no_warnings_of_numpy(tmp_path):
    for name, width in (("POSITION", 3), ("NORMAL", 3), ("TEXCOORD_0", 2), ("COLOR_0", 4)):
        for value in (3e38, -3e38, 1e-44, -1.0):
            writer = Writer()
            array = SQUARE.copy() if name == "POSITION" else np.ones((4, width), np.float32)
            array[0] = value
            writer.node(mesh=writer.mesh(None, **{name: array}), scale=[2, 2, 2])
            (tmp_path / "a.glb").write_bytes(writer.glb())
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                rw.load(tmp_path / "a.glb").scene.intersect((0, 0, 1), (0, 0, -1))
