"""A glTF file taken apart: its JSON and its bytes, from one file or from several in one folder."""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path
from typing import Any, NoReturn
from urllib.parse import unquote, unquote_to_bytes, urlsplit

from ...io.quiet import warn_caller
from ..beside import cased
from .meshopt import NAMES, compressed, decompressed
from .part import Part

_MAGIC, _JSON, _BIN = b"glTF", b"JSON", b"BIN\0"

# Extensions that are read, or have no visible effect.
_KNOWN = frozenset(
    {
        *NAMES,
        "EXT_mesh_gpu_instancing",
        "EXT_texture_webp",
        "KHR_draco_mesh_compression",
        "KHR_lights_punctual",
        "KHR_materials_dispersion",
        "KHR_materials_emissive_strength",
        "KHR_materials_ior",
        "KHR_materials_iridescence",
        "KHR_materials_pbrSpecularGlossiness",
        "KHR_materials_transmission",
        "KHR_materials_unlit",
        "KHR_materials_volume",
        "KHR_mesh_quantization",
        "KHR_texture_transform",
        "KHR_xmp_json_ld",
    }
)


class Document:
    """A glTF 2.0 file, .glb or .gltf, whose buffers and views are where they say.

    Attributes
    ----------
    path : Path
        The file.
    root : Part
        Its JSON.

    Raises
    ------
    ValueError
        If it is not a file of this kind, is cut short, needs an extension that is not known, or one of its
        files is missing or outside of its folder.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        text, self._binary = _chunks(path.read_bytes())
        self.root = Part(_json(text))
        self._check_version()
        self._check_extensions()
        self._told: list[str] = []
        self._buffers: dict[int, memoryview] = {}
        self._decompressed: dict[int, memoryview | None] = {}
        self._all_buffers = self.root.parts("buffers")
        self._all_views = self.root.parts("bufferViews")

    def tell(self, what: str) -> None:
        """Keep what there is to warn of, once."""
        if what not in self._told:
            self._told.append(what)

    def warn(self) -> None:
        """Warn of all that was kept."""
        unknown = [name for name in self.root.texts("extensionsUsed") if name not in _KNOWN]
        if unknown:
            self.tell(f"its extensions {', '.join(sorted(set(unknown)))} are left out")
        for what in self._told:
            warn_caller(f"{self.path.name}: {what}")
        self._told.clear()

    def view(self, part: Part, name: str = "bufferView") -> tuple[memoryview, int | None]:
        """Return the bytes of the view that a part names, and how far apart its elements are if it says."""
        index = part.reference(name, "bufferViews", len(self._all_views))
        view = self._all_views[index]
        stride = view.integer("byteStride", least=4, most=252) if "byteStride" in view else None
        if index not in self._decompressed:
            self._decompressed[index] = self._decompress(view)
        whole = self._decompressed[index]
        return (self._bytes_of(view) if whole is None else whole), stride

    def _bytes_of(self, part: Part) -> memoryview:
        """Return the bytes of a buffer that a view tells, or the compressed form of one."""
        buffer = self._buffer(part.reference("buffer", "buffers", len(self._all_buffers)))
        start, length = part.integer("byteOffset", 0), part.integer("byteLength", least=1)
        if start + length > len(buffer):
            raise ValueError(f"{part.place} ends at byte {start + length} of a buffer of {len(buffer)}")
        return buffer[start : start + length]

    def _decompress(self, view: Part) -> memoryview | None:
        """Return the bytes of a view that is compressed; None if it is not, or need not be read so."""
        told = compressed(view)
        if told is None:
            return None
        is_required = any(name in self.root.texts("extensionsRequired") for name in NAMES)
        found = decompressed(self.path, told, self._bytes_of(told), is_required)
        length = view.integer("byteLength", least=1)
        if found is not None and len(found) < length:
            raise ValueError(f"{told.place} holds {len(found)} bytes, and its view {length}")
        return found if found is None else found[:length]

    def bytes_at(self, part: Part, length: int | None = None) -> bytes | memoryview:
        """Return what the ``uri`` of a part leads to, and of a file no more than `length` bytes."""
        uri, place = part.text("uri"), part.at("uri")
        if uri[:5].lower() == "data:":
            return _inline(uri, place)
        kept = self._beside(uri, place)
        try:
            with open(kept, "rb") as file:
                return file.read(-1 if length is None else length)
        except OSError as error:
            raise ValueError(f"{place}: {kept.name} cannot be read ({error.strerror})") from error

    def _beside(self, uri: str, place: str) -> Path:
        """Return the path of a file in the folder of this one, or in a folder within it."""
        shown = uri if len(uri) <= 40 else f"{uri[:37]}..."
        name = unquote(uri)
        if urlsplit(uri).scheme or "\0" in name:
            raise ValueError(f"{place} must be a file beside it or data, and is {shown!r}")
        folder = self.path.parent.resolve()
        try:
            found = cased(folder, name).resolve()
            there = found.is_file()
        except (OSError, RuntimeError) as error:
            raise ValueError(f"{place} leads nowhere: {shown!r}") from error
        if not found.is_relative_to(folder):
            raise ValueError(f"{place} leads out of the file's folder: {shown!r}")
        if not there:
            raise ValueError(f"{place}: there is no file {shown!r} beside it")
        return found

    def _buffer(self, index: int) -> memoryview:
        if index not in self._buffers:
            part = self._all_buffers[index]
            length = part.integer("byteLength", least=1)
            if "uri" in part:
                data = memoryview(self.bytes_at(part, length))
            elif index == 0 and self._binary is not None:
                data = self._binary
            else:
                raise ValueError(f"{part.place} has neither a uri nor a chunk of the file")
            if len(data) < length:
                raise ValueError(f"{part.place} must hold {length} bytes, and there are {len(data)}")
            self._buffers[index] = data[:length]
        return self._buffers[index]

    def _check_version(self) -> None:
        asset = self.root.part("asset")
        version = asset.text("version")
        least = asset.text("minVersion", "2.0")
        if version.split(".")[0] != "2" or least != "2.0":
            needed = version if least == "2.0" else least
            raise ValueError(f"it is glTF {needed[:20]}, and only 2.0 is read")

    def _check_extensions(self) -> None:
        for name in self.root.texts("extensionsRequired"):
            if name not in _KNOWN:
                raise ValueError(f"it needs the extension {name[:60]}, which is not supported")


def _chunks(data: bytes) -> tuple[memoryview, memoryview | None]:
    """Return the JSON of a file, and the binary chunk of a GLB (glTF 2.0, 4.4)."""
    whole = memoryview(data)
    if not data.startswith(_MAGIC):
        return whole, None
    if len(data) < 20:
        raise ValueError(f"it is cut short: a GLB has at least 20 bytes, and there are {len(data)}")
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        raise ValueError(f"it is GLB {version}, and only 2 is read")
    if length > len(data):
        raise ValueError(f"it is cut short: it has {length} bytes by its header, and there are {len(data)}")
    found: dict[bytes, memoryview] = {}
    at = 12
    # A few bytes after the last chunk are padding by some programs.
    while at + 8 <= length:
        size, kind = struct.unpack_from("<I4s", data, at)
        if size > length - at - 8:
            raise ValueError(f"its chunk at byte {at} has {size} bytes, and {length - at - 8} are left")
        if not found and kind != _JSON:
            raise ValueError(f"its first chunk must be JSON, and is {kind!r}")
        found.setdefault(kind, whole[at + 8 : at + 8 + size])
        at += 8 + size
    if _JSON not in found:
        raise ValueError(f"it has no chunk of JSON in the {length} bytes that its header tells of")
    return found[_JSON], found.get(_BIN)


def _json(text: memoryview) -> Any:
    def constant(name: str) -> NoReturn:
        raise ValueError(f"its JSON holds {name}, which is not a number")

    try:
        return json.loads(bytes(text).decode("utf-8-sig"), parse_constant=constant)
    except RecursionError:
        raise ValueError("its JSON is nested too deep") from None
    except UnicodeDecodeError as error:
        raise ValueError(f"its JSON is not UTF-8 at byte {error.start}") from None
    except json.JSONDecodeError as error:
        raise ValueError(f"its JSON is broken at character {error.pos}: {error.msg}") from None


def _inline(uri: str, place: str) -> bytes:
    """Return what a data: URI holds (RFC 2397)."""
    head, comma, body = uri.partition(",")
    if not comma:
        raise ValueError(f"{place} is a data: URI without a comma")
    try:
        return base64.b64decode(body, validate=True) if head.endswith(";base64") else unquote_to_bytes(body)
    except ValueError as error:
        raise ValueError(f"{place} is a data: URI whose base64 is broken ({error})") from None
