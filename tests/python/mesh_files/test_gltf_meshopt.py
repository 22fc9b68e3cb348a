"""glTF files whose views are compressed by meshoptimizer, as the package meshopt writes them."""

import json
import sys

import numpy as np
import pytest
from gltf_writer import CORNERS, SQUARE, Writer, glb

import raywright as rw

NAME = "EXT_meshopt_compression"
KINDS = (("VEC3", 4, 5126), ("SCALAR", 6, 5123))


def compressed(views, is_required=True, name=NAME, **more):
    """Return a square whose views stand in the file in a compressed form, and in plain form if not required.

    `views` has the plain bytes of positions and of indices, their compressed form, and what is said of it.
    """
    writer = Writer()
    accessors = []
    for (plain, data, told), (kind, count, code) in zip(views, KINDS, strict=True):
        number = writer.view(data)
        own = writer.json["bufferViews"][number]
        view = {"buffer": 1, "byteOffset": 0, "byteLength": len(plain)}
        if not is_required:
            number = writer.view(plain)
            view = writer.json["bufferViews"][number]
        view = writer.add("bufferViews", {**view, "extensions": {name: {**own, **told, **more}}})
        accessor = {"bufferView": view, "componentType": code, "count": count, "type": kind}
        accessors.append(writer.add("accessors", accessor))
    primitive = {"attributes": {"POSITION": accessors[0]}, "indices": accessors[1]}
    writer.node(mesh=writer.add("meshes", {"primitives": [primitive]}))
    # A missing buffer: compressed data need have no other form.
    nowhere = {"byteLength": 1000, "extensions": {name: {"fallback": True}}}
    writer.json["buffers"] = [{"byteLength": len(writer.data)}, nowhere]
    writer.json["extensionsUsed"] = [name]
    writer.json["extensionsRequired"] = [name] if is_required else []
    return glb(json.dumps(writer.json).encode(), writer.data)


@pytest.fixture(scope="module")
def square():
    meshopt = pytest.importorskip("meshopt")
    data = meshopt.encode_gltf_buffer(SQUARE, "ATTRIBUTES")
    positions = SQUARE.tobytes(), data, {"byteStride": 12, "count": 4, "mode": "ATTRIBUTES"}
    told = {"byteStride": 2, "count": 6, "mode": "TRIANGLES"}
    return [positions, (CORNERS.tobytes(), meshopt.encode_gltf_buffer(CORNERS, "TRIANGLES"), told)]


def triangles(mesh):
    """The corners of faces, each face from its least one on: the codec may begin with another."""
    corners = mesh.vertices[mesh.faces]
    return sorted(sorted(face) for face in corners.tolist())


@pytest.mark.parametrize("is_required", [True, False])
@pytest.mark.parametrize("name", [NAME, "KHR_meshopt_compression"])
def test_a_compressed_square_is_the_square(tmp_path, square, is_required, name):
    (tmp_path / "square.glb").write_bytes(compressed(square, is_required, name))
    [mesh] = rw.Scene(tmp_path / "square.glb").shapes
    assert np.array_equal(mesh.vertices, SQUARE)
    assert triangles(mesh) == triangles(rw.Mesh(SQUARE, CORNERS.reshape(-1, 3)))
    assert rw.Scene(mesh).intersect((0.25, 0.5, 1), (0, 0, -1)).normal.tolist() == [0, 0, 1]


def test_filters_and_sequences_are_undone(tmp_path, square):
    meshopt = pytest.importorskip("meshopt")
    rows = meshopt.encode_filter_exp(SQUARE, 15)
    told = {"byteStride": 12, "count": 4, "mode": "ATTRIBUTES", "filter": "EXPONENTIAL"}
    positions = SQUARE.tobytes(), meshopt.encode_gltf_buffer(rows, "ATTRIBUTES"), told
    data = meshopt.encode_gltf_buffer(CORNERS, "INDICES")
    indices = CORNERS.tobytes(), data, {"byteStride": 2, "count": 6, "mode": "INDICES"}
    (tmp_path / "square.glb").write_bytes(compressed([positions, indices]))
    [mesh] = rw.Scene(tmp_path / "square.glb").shapes
    assert np.allclose(mesh.vertices, SQUARE, rtol=0, atol=2**-14)
    assert np.array_equal(mesh.faces, CORNERS.reshape(-1, 3))


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"mode": "FACES"}, "mode must be one of ATTRIBUTES, TRIANGLES, INDICES, and is FACES"),
        ({"filter": "BLUR"}, "filter must be one of NONE, OCTAHEDRAL, .*, and is BLUR"),
        ({"count": 10**9}, "has .* bytes, too few for 1000000000 rows of 12"),
        ({"count": 3}, "holds (no bytes of meshoptimizer|36 bytes, and its view 48)"),
        ({"byteOffset": 10**6}, "ends at byte .* of a buffer of"),
        ({"byteLength": 9}, "holds no bytes of meshoptimizer"),
    ],
)
def test_broken_ones_are_refused(tmp_path, square, more, message):
    (tmp_path / "broken.glb").write_bytes(compressed(square, **more))
    with pytest.raises(ValueError, match=rf"broken\.glb is not .*{message}"):
        rw.Scene(tmp_path / "broken.glb")


def test_without_the_package_it_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "meshopt", None)
    told = {"byteStride": 12, "count": 4, "mode": "ATTRIBUTES"}
    views = [(SQUARE.tobytes(), b"none", told), (CORNERS.tobytes(), b"none", told)]
    path = tmp_path / "square.glb"
    path.write_bytes(compressed(views))
    for read in (rw.Scene, rw.load):
        with pytest.raises(
            ImportError, match=r"square.glb is compressed by meshoptimizer, .*raywright\[meshopt\]"
        ):
            read(path)
    # The uncompressed fallback is read.
    path.write_bytes(compressed(views, is_required=False))
    [mesh] = rw.Scene(path).shapes
    assert np.array_equal(mesh.vertices, SQUARE)
