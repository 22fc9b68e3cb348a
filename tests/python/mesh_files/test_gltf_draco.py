"""glTF files that are compressed by Draco, as DracoPy writes them."""

import sys

import numpy as np
import pytest
from gltf_writer import CORNERS, SQUARE, Writer

import raywright as rw

NAME = "KHR_draco_mesh_compression"
NORMALS = np.tile((0.0, 0.0, 1.0), (4, 1))
UV = SQUARE[:, :2].astype(np.float64)


def compressed(data, is_required=True, ids=None, count=4):
    """Return a square whose numbers are nowhere but in a view of Draco's bytes."""
    writer = Writer()
    place = {"componentType": 5126, "count": count, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}
    of = {
        "POSITION": writer.add("accessors", place),
        "NORMAL": writer.add("accessors", {"componentType": 5126, "count": 4, "type": "VEC3"}),
        "TEXCOORD_0": writer.add("accessors", {"componentType": 5126, "count": 4, "type": "VEC2"}),
    }
    indices = writer.add("accessors", {"componentType": 5123, "count": 6, "type": "SCALAR"})
    ids = ids or {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}
    extension = {"bufferView": writer.view(data), "attributes": ids}
    primitive = {"attributes": of, "indices": indices, "extensions": {NAME: extension}}
    writer.node(mesh=writer.add("meshes", {"primitives": [primitive]}))
    writer.json["extensionsUsed"] = [NAME]
    if is_required:
        writer.json["extensionsRequired"] = [NAME]
    return writer.glb()


@pytest.fixture(scope="module")
def square():
    draco = pytest.importorskip("DracoPy")
    faces = CORNERS.reshape(-1, 3).astype(np.uint32)
    data = draco.encode(
        SQUARE, faces, quantization_bits=14, preserve_order=True, normals=NORMALS, tex_coord=UV
    )
    kinds = {0: "POSITION", 1: "NORMAL", 3: "TEXCOORD_0"}
    ids = {kinds[one["attribute_type"]]: one["unique_id"] for one in draco.decode(data).attributes}
    return data, ids


def test_a_compressed_square_is_the_square(tmp_path, square):
    data, ids = square
    (tmp_path / "square.glb").write_bytes(compressed(data, ids=ids))
    [mesh] = rw.Scene(tmp_path / "square.glb").shapes
    corners = mesh.vertices[mesh.faces]
    assert np.allclose(corners, SQUARE[CORNERS].reshape(2, 3, 3), rtol=0, atol=2**-14)
    assert np.allclose(mesh.normals, NORMALS, rtol=0, atol=1e-6)
    # glTF has v from the top of pictures downwards.
    assert np.allclose(mesh.uv, np.column_stack([mesh.vertices[:, 0], 1 - mesh.vertices[:, 1]]), atol=2**-10)
    assert rw.Scene(mesh).intersect((0.25, 0.5, 1), (0, 0, -1)).t == pytest.approx(1, abs=2**-14)


def test_a_broken_one_is_refused(tmp_path, square):
    data, ids = square
    path = tmp_path / "square.glb"
    for content, told in (
        (compressed(data[: len(data) // 2], ids=ids), "holds no mesh of Draco"),
        (compressed(data, ids={"POSITION": 9}), "attributes.POSITION is 9, which the mesh of Draco has not"),
        (compressed(data, ids=ids, count=5), r"\(5, 3\) numbers, and \(4, 3\) are compressed"),
    ):
        path.write_bytes(content)
        with pytest.raises(ValueError, match=told):
            rw.Scene(path)


def test_without_the_package_it_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "DracoPy", None)
    path = tmp_path / "square.glb"
    path.write_bytes(compressed(b"DRACO"))
    for read in (rw.Scene, rw.load):
        with pytest.raises(ImportError, match=r"square.glb is compressed by Draco, .*raywright\[draco\]"):
            read(path)
