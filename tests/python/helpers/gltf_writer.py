"""glTF files written number by number, so that tests know what is in them; also those that are broken."""

import base64
import json
import struct
from typing import Any

import numpy as np

import raywright as rw

TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
CODES = {"b": 5120, "B": 5121, "h": 5122, "H": 5123, "I": 5125, "f": 5126}
# Two triangles in the plane z = 0 from (0, 0) to (1, 1), whose normals are +z.
SQUARE = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], np.float32)
CORNERS = np.array([0, 1, 2, 0, 2, 3], np.uint16)


class Writer:
    """A document that grows: its JSON in `json`, its one buffer in `data`."""

    def __init__(self) -> None:
        self.json: dict[str, Any] = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}]}
        self.data = b""

    def add(self, name: str, value: dict[str, Any]) -> int:
        """Add to one of the lists, and return which it is."""
        self.json.setdefault(name, []).append(value)
        return len(self.json[name]) - 1

    def view(self, data: bytes, **more: Any) -> int:
        self.data += b"\0" * (-len(self.data) % 4)
        where = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data)}
        self.data += data
        return self.add("bufferViews", {**where, **more})

    def accessor(self, array: np.ndarray, **more: Any) -> int:
        array = np.ascontiguousarray(array)
        columns = 1 if array.ndim == 1 else int(np.prod(array.shape[1:]))
        told = {"componentType": CODES[array.dtype.char], "count": len(array), "type": TYPES[columns]}
        return self.add("accessors", {"bufferView": self.view(array.tobytes()), **told, **more})

    def mesh(self, material: dict[str, Any] | None = None, indices: Any = CORNERS, **attributes: Any) -> int:
        """Add a mesh of one primitive, a square if nothing else is said."""
        attributes.setdefault("POSITION", SQUARE)
        held = {
            name: value if isinstance(value, int) else self.accessor(value)
            for name, value in attributes.items()
        }
        primitive: dict[str, Any] = {"attributes": held}
        if indices is not None:
            primitive["indices"] = self.accessor(indices)
        if material is not None:
            primitive["material"] = self.add("materials", material)
        return self.add("meshes", {"primitives": [primitive]})

    def node(self, parent: int | None = None, **node: Any) -> int:
        index = self.add("nodes", node)
        siblings = self.json["scenes"][0]["nodes"]
        if parent is not None:
            siblings = self.json["nodes"][parent].setdefault("children", [])
        siblings.append(index)
        return index

    def light(self, **light: Any) -> dict[str, Any]:
        """Add a light, and return the extensions of a node that holds it."""
        lights = self.json.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})
        lights["lights"].append(light)
        self.json["extensionsUsed"] = ["KHR_lights_punctual"]
        return {"KHR_lights_punctual": {"light": len(lights["lights"]) - 1}}

    def picture(self, data: bytes) -> dict[str, Any]:
        """Add a picture file as a texture, and return what a material names it by."""
        image = self.add("images", {"bufferView": self.view(data), "mimeType": "image/png"})
        return {"index": self.add("textures", {"source": image})}

    def glb(self) -> bytes:
        if self.data:
            self.json["buffers"] = [{"byteLength": len(self.data)}]
        return glb(json.dumps(self.json).encode(), self.data)

    def gltf(self) -> bytes:
        """Return it as JSON, with its buffer inline."""
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        self.json["buffers"] = [{"byteLength": len(self.data), "uri": uri}]
        return json.dumps(self.json).encode()


def glb(text: bytes, data: bytes = b"") -> bytes:
    """Return a GLB of two chunks."""
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    if data:
        chunks += struct.pack("<I4s", len(data), b"BIN\0") + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def square(**node: Any) -> Writer:
    """Return a document with a square at one node."""
    writer = Writer()
    writer.node(mesh=writer.mesh(), **node)
    return writer


def own(shot: rw.rendering.RenderSetup) -> tuple[Any, ...]:
    """The shapes of a file without a camera: without the floor and the lamp of what has no light."""
    return shot.scene.shapes if shot.scene.environment is None else shot.scene.shapes[:-2]
