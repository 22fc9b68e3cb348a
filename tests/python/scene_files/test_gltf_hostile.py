"""glTF files that are broken, or made to do harm, are refused in one line."""

import json
import os
import struct
import sys
import zlib
from pathlib import Path

import numpy as np
import pytest
from gltf_writer import CORNERS, SQUARE, Writer, glb, square
from refusals import Reader

from raywright.scene_files.gltf import read_gltf

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="limits of memory are Linux's")


@pytest.fixture(scope="module")
def reader():
    made = Reader()
    yield made
    made.close()


def png_header(width: int, height: int) -> bytes:
    body = b"IHDR" + struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    data = b"IDAT" + zlib.compress(b"\0" * 1000)
    chunks = [(body, 13), (data, len(data) - 4), (b"IEND", 0)]
    made = b"".join(
        struct.pack(">I", size) + one + struct.pack(">I", zlib.crc32(one)) for one, size in chunks
    )
    return b"\x89PNG\r\n\x1a\n" + made


def jpeg_header(width: int, height: int) -> bytes:
    frame = struct.pack(">BHH", 8, height, width) + b"\x03\x01\x11\0\x02\x11\0\x03\x11\0"
    scan = b"\x03\x01\0\x02\0\x03\0\0\x3f\0"
    segments = b"".join(
        b"\xff" + kind + struct.pack(">H", len(body) + 2) + body
        for kind, body in ((b"\xc0", frame), (b"\xda", scan))
    )
    return b"\xff\xd8" + segments + bytes(200)


def pictured(data: bytes) -> bytes:
    writer = Writer()
    writer.node(mesh=writer.mesh({"pbrMetallicRoughness": {"baseColorTexture": writer.picture(data)}}))
    return writer.glb()


def changed(change) -> bytes:
    """Return a GLB of a square whose JSON is not what it should be."""
    writer = square()
    writer.json["buffers"] = [{"byteLength": len(writer.data)}]
    change(writer.json)
    return glb(json.dumps(writer.json).encode(), writer.data)


def setting(where: str, name: str, value):
    """Return a change of one number: of the list `where`, its first, or of accessors that of the corners."""

    def change(tree):
        held = tree[where][1 if where == "accessors" else 0]
        held[name] = value

    return changed(change)


def primitive(**values) -> bytes:
    return changed(lambda tree: tree["meshes"][0]["primitives"][0].update(values))


def nodes(*children, roots=(0,)) -> bytes:
    def change(tree):
        tree["nodes"] = [{"children": list(some)} if some else {"mesh": 0} for some in children]
        tree["scenes"] = [{"nodes": list(roots)}]

    return changed(change)


def vertices(array, indices=CORNERS, **attributes) -> bytes:
    writer = Writer()
    writer.node(mesh=writer.mesh(POSITION=array, indices=indices, **attributes))
    return writer.glb()


def buffers(uri) -> bytes:
    writer = square()
    writer.gltf()
    writer.json["buffers"][0]["uri"] = uri
    return json.dumps(writer.json).encode()


GOOD = square().glb()
NAN = SQUARE.copy()
NAN[2, 1] = np.nan

BROKEN = {
    "empty.glb": (b"", "JSON"),
    "text.gltf": (b"hello", "JSON is broken at character 0"),
    "latin.gltf": (b'{"a": "\xff"}', "is not UTF-8 at byte 7"),
    "list.gltf": (b"[]", "its JSON must be an object, and is a list of 0"),
    "nan.gltf": (b'{"asset": NaN}', "its JSON holds NaN"),
    "deep.gltf": (b"[" * 100_000, "nested too deep"),
    "deep.glb": (glb(b'{"asset":' * 100_000 + b"1" + b"}" * 100_000), "nested too deep"),
    "head.glb": (GOOD[:12], "cut short: a GLB has at least 20 bytes, and there are 12"),
    "version.glb": (GOOD[:4] + b"\1" + GOOD[5:], "it is GLB 1, and only 2 is read"),
    "half.glb": (GOOD[: len(GOOD) // 2], "cut short"),
    "chunk.glb": (GOOD[:12] + b"\xff\xff\xff\xff" + GOOD[16:], "has 4294967295 bytes, and"),
    "kind.glb": (GOOD[:16] + b"BIN\0" + GOOD[20:], "its first chunk must be JSON"),
    "nothing.glb": (glb(b"{}"), "asset.version must be a text, and is missing"),
    "old.glb": (changed(lambda tree: tree["asset"].update(version="1.0")), "it is glTF 1.0"),
    "newer.glb": (changed(lambda tree: tree["asset"].update(minVersion="2.7")), "it is glTF 2.7"),
    "other.glb": (
        changed(lambda tree: tree.update(extensionsRequired=["KHR_other"])),
        "it needs the extension KHR_other, which is not supported",
    ),
    "faceless.glb": (changed(lambda tree: tree["scenes"][0].clear()), "holds no faces"),
    "buffer.glb": (setting("buffers", "byteLength", 10**9), "must hold 1000000000 bytes, and there are 60"),
    "no buffer.glb": (
        glb(json.dumps({**square().json, "buffers": [{"byteLength": 60}]}).encode()),
        "neither",
    ),
    "view.glb": (
        setting("bufferViews", "byteLength", 61),
        "[0] ends at byte 61 of a buffer of 60",
    ),
    "view start.glb": (setting("bufferViews", "byteOffset", 2**52), "of a buffer of 60"),
    "view back.glb": (setting("bufferViews", "byteOffset", -4), "byteOffset must be at least 0, and is -4"),
    "view of.glb": (setting("bufferViews", "buffer", 7), "buffer is 7, and there is only 1 of buffers"),
    "stride.glb": (setting("bufferViews", "byteStride", 8), "has elements of 12 bytes, 8 apart"),
    "stride 0.glb": (setting("bufferViews", "byteStride", 0), "must be between 4 and 252, and is 0"),
    "count.glb": (setting("accessors", "count", 7), "ends at byte 14 of a view of 12"),
    "count 1e9.glb": (setting("accessors", "count", 10**9), "ends at byte 2000000000 of a view of 12"),
    "count -1.glb": (setting("accessors", "count", -1), "count must be at least 1, and is -1"),
    "count 1e300.glb": (setting("accessors", "count", 1e300), "count must be at least 1, and is 1e+300"),
    "count digits.glb": (setting("accessors", "count", 10**400), "and is a very great number"),
    "count half.glb": (setting("accessors", "count", 1.5), "count must be an integer, and is 1.5"),
    "count true.glb": (setting("accessors", "count", True), "count must be an integer, and is true"),
    "offset.glb": (setting("accessors", "byteOffset", 4), "ends at byte 16 of a view of 12"),
    "component.glb": (setting("accessors", "componentType", 5124), "componentType must be one of"),
    "type.glb": (setting("accessors", "type", "VEC9"), "type must be one of"),
    "zeros.glb": (
        changed(
            lambda tree: tree["accessors"].__setitem__(
                0, {"componentType": 5126, "count": 10**9, "type": "VEC3"}
            )
        ),
        "has 1000000000 elements without data in the file",
    ),
    "sparse.glb": (
        setting("accessors", "sparse", {"count": 10**9, "indices": {}, "values": {}}),
        "sparse.count must be between 1 and 6",
    ),
    "index.glb": (vertices(SQUARE, np.array([0, 1, 4], np.uint8)), "has index 4, and there are 4 vertices"),
    "signed.glb": (vertices(SQUARE, np.array([0, 1, -1], np.int8)), "must be unsigned integers"),
    "pair.glb": (vertices(SQUARE, np.array([0, 1], np.uint8)), "has 2 corners of triangles"),
    "vertex nan.glb": (vertices(NAN), "accessors[0], POSITION, holds NaN or infinity in element 2"),
    "flat.glb": (vertices(SQUARE[:, :2]), "accessors[0] must have 3 numbers an element for POSITION"),
    "accessor.glb": (primitive(indices=9), "indices is 9, and there are only 2 of accessors"),
    "material.glb": (primitive(material=0), "material is 0, and there are none of materials"),
    "mode.glb": (primitive(mode=9), "mode must be between 0 and 6, and is 9"),
    "attributes.glb": (primitive(attributes=[]), "attributes must be an object, and is a list of 0"),
    "uneven.glb": (
        vertices(SQUARE, np.array([0, 1, 2], np.uint8), NORMAL=SQUARE[:3]),
        "has 4 of POSITION, and 3 of others",
    ),
    "normals.glb": (primitive(attributes={"POSITION": 0, "NORMAL": 1}), "must have 3 numbers an element"),
    "mesh.glb": (setting("nodes", "mesh", 1), "nodes[0].mesh is 1, and there is only 1 of meshes"),
    "cycle.glb": (nodes([1], [2], [0]), "nodes[0] is reached twice: nodes must be a tree"),
    "self.glb": (nodes([0]), "nodes[0] is reached twice"),
    "twice.glb": (nodes([1, 1], []), "nodes[1] is reached twice"),
    "laughs.glb": (nodes(*([i + 1, i + 1] for i in range(64)), []), "is reached twice"),
    "child.glb": (nodes([5]), "nodes[0].children[0] is 5, and there is only 1 of nodes"),
    "root.glb": (nodes([], roots=(3,)), "scenes[0].nodes[0] is 3"),
    "matrix.glb": (setting("nodes", "matrix", [1] * 15), "nodes[0].matrix must be 16 finite numbers"),
    "perspective.glb": (setting("nodes", "matrix", [1] * 16), "must have (0, 0, 0, 1) as its last row"),
    "huge.glb": (setting("nodes", "scale", [1e999, 1, 1]), "JSON holds Infinity"),
    "turn.glb": (setting("nodes", "rotation", [0, 0, 0, 0]), "nodes[0].rotation must not be zero"),
    "far.glb": (
        changed(
            lambda tree: tree.update(
                nodes=[{"scale": [1e300] * 3, "children": [1]}, {"scale": [1e300] * 3, "mesh": 0}]
            )
        ),
        "nodes[1] has a transform that is not finite",
    ),
    "light.glb": (
        setting("nodes", "extensions", {"KHR_lights_punctual": {"light": 0}}),
        "light is 0, and there are none of lights",
    ),
    "camera.glb": (setting("nodes", "camera", -1), "nodes[0].camera must be at least 0, and is -1"),
    "png.glb": (pictured(png_header(31623, 31623)), "has more than 89478485 points by its header"),
    "jpeg.glb": (pictured(jpeg_header(31623, 31623)), "has more than 89478485 points by its header"),
    "png cut.glb": (pictured(png_header(9000, 9000)), "images[0] cannot be read"),
    "jpeg cut.glb": (pictured(jpeg_header(9000, 9000)), "images[0] cannot be read"),
    "noise.glb": (pictured(bytes(range(256))), "images[0] cannot be read: it is not a picture that is PNG"),
    "script.glb": (pictured(b"%!PS-Adobe-3.0 EPSF-3.0\n"), "it is not a picture that is PNG"),
    "no uri.gltf": (buffers(5), "buffers[0].uri must be a text, and is 5"),
    "up.gltf": (buffers("../secret.bin"), "leads out of the file's folder: '../secret.bin'"),
    "up coded.gltf": (buffers("%2e%2e/secret.bin"), "leads out of the file's folder"),
    "root.gltf": (buffers("/etc/passwd"), "leads out of the file's folder: '/etc/passwd'"),
    "device.gltf": (buffers("/dev/zero"), "leads out of the file's folder: '/dev/zero'"),
    "linked.gltf": (buffers("link.bin"), "leads out of the file's folder: 'link.bin'"),
    "web.gltf": (buffers("https://example.org/a.bin"), "must be a file beside it or data"),
    "scheme.gltf": (buffers("file:///etc/passwd"), "must be a file beside it or data"),
    "zero byte.gltf": (buffers("a%00b"), "must be a file beside it or data"),
    "missing.gltf": (buffers("gone.bin"), "there is no file 'gone.bin' beside it"),
    "folder.gltf": (buffers("."), "there is no file '.' beside it"),
    "pipe.gltf": (buffers("pipe"), "there is no file 'pipe' beside it"),
    "long.gltf": (buffers("a" * 10_000), "buffers[0].uri"),
    "short.gltf": (buffers("short.bin"), "buffers[0] must hold 60 bytes, and there are 5"),
    "comma.gltf": (buffers("data:application/octet-stream;base64"), "is a data: URI without a comma"),
    "base64.gltf": (buffers("data:;base64,A!A="), "is a data: URI whose base64 is broken"),
    "data.gltf": (buffers("data:,hello"), "buffers[0] must hold 60 bytes, and there are 5"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_files_are_refused_in_one_line(tmp_path, reader, name):
    data, message = BROKEN[name]
    (tmp_path / "secret.bin").write_bytes(bytes(60))
    folder = tmp_path / "folder"
    folder.mkdir()
    (folder / "link.bin").symlink_to(tmp_path / "secret.bin")
    (folder / "short.bin").write_bytes(b"hello")
    os.mkfifo(folder / "pipe")
    (folder / name).write_bytes(data)
    assert message in reader.refuse("gltf", folder / name)
    # Readers of meshes alone report the same.
    if name not in ("camera.glb", "light.glb"):
        assert message in reader.refuse("mesh", folder / name)


def test_whatever_is_cut_off_is_missed(tmp_path):
    path = tmp_path / "cut.glb"
    for length in range(len(GOOD)):
        path.write_bytes(GOOD[:length])
        with pytest.raises(ValueError, match=r"cut\.glb is not a glTF file that can be read"):
            read_gltf(path)


def test_changed_bytes_do_no_more_than_be_refused(tmp_path, reader):
    """Any of some hundred files with a few bytes changed is read, or refused as it should be."""
    rng = np.random.default_rng(7)
    writer = Writer()
    picture = writer.picture(png_header(8, 8))
    writer.node(mesh=writer.mesh({"emissiveFactor": [1, 1, 1], "emissiveTexture": picture}))
    writer.node(extensions=writer.light(type="spot"), scale=[1, 2, 3])
    whole = np.frombuffer(writer.glb(), np.uint8)
    path = tmp_path / "changed.glb"
    path.write_bytes(writer.glb())
    assert reader.read("gltf", path).kind == "nothing"
    refused = 0
    for _ in range(600):
        data = whole.copy()
        where = rng.integers(0, len(data), rng.integers(1, 4))
        # Digits and marks of JSON more often than other bytes.
        marks = np.frombuffer(b'0123456789-.,:[]{}"e', np.uint8)
        data[where] = (
            rng.choice(marks, len(where)) if rng.random() < 0.8 else rng.integers(0, 256, len(where))
        )
        path.write_bytes(data.tobytes())
        came = reader.read("gltf", path)
        assert came.kind in ("nothing", "ValueError", "RuntimeWarning"), came
        assert came.seconds < 1
        assert came.bytes < 10**9
        refused += came.kind == "ValueError"
    assert refused > 300


def test_a_missing_file_is_told_as_such(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"no such file: .*gone\.glb"):
        read_gltf(tmp_path / "gone.glb")
    with pytest.raises(ValueError, match="is a folder, not a glTF file"):
        read_gltf(Path(tmp_path))
