"""From XML to the dicts of Mitsuba's Python interface: defaults, includes, references and transforms."""

from __future__ import annotations

import errno
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NoReturn
from xml.parsers import expat

from .errors import SceneError
from .transforms import of_elements

# Elements that are plugins: elements within them are their parameters.
_OBJECTS = (
    "scene",
    "shape",
    "bsdf",
    "emitter",
    "sensor",
    "film",
    "sampler",
    "rfilter",
    "integrator",
    "texture",
    "medium",
    "phase",
    "volume",
)
# Mitsuba's own limit of include depth; then more files, and deeper elements, than any scene has.
_MOST_INCLUDES, _MOST_FILES, _MOST_LEVELS = 15, 1000, 64

_COMMENT = re.compile(rb"<!--(.*?)-->", re.DOTALL)

Tree = dict[str, Any]


class Element:
    """An element of a file, with the elements in it."""

    __slots__ = ("attributes", "children", "line", "tag")

    def __init__(self, tag: str, attributes: dict[str, str], line: int) -> None:
        self.tag, self.attributes, self.line = tag, attributes, line
        self.children: list[Element] = []


def read_xml(
    path: Path, parameters: Mapping[str, Any], folder: Path | None = None
) -> tuple[Tree, list[Path]]:
    """Return the scene of an XML file as a dict, and the folders of its files.

    Parameters
    ----------
    path : Path
        The file.
    parameters : mapping of str to anything
        Values of ``$name``, in place of the file's own defaults.
    folder : Path, optional
        Last folder of files.

    Raises
    ------
    FileNotFoundError
        If the file, or one that it includes, is missing.
    ValueError
        If it is not XML, has a DOCTYPE, or is not as Mitsuba's scenes are; the error gives the line. If a
        parameter is asked for nowhere in it.
    """
    reader = _Reader({name: _text(value) for name, value in parameters.items()}, folder)
    tree = reader.file(path, 0)
    if tree.get("type") != "scene":
        raise SceneError(f"{path} must hold a <scene>")
    for name in parameters:
        if name not in reader.asked:
            known = ", ".join(sorted(reader.asked)) or "none"
            raise SceneError(f"{name} is not a parameter of {path}; it has {known}")
    return tree, reader.folders


class _Reader:
    """State shared by the files of one scene: the values of their parameters, and the folders of files."""

    def __init__(self, given: dict[str, str], folder: Path | None) -> None:
        self.values = dict(given)
        # Names of parameters that the files use.
        self.asked: set[str] = set()
        self.folders: list[Path] = [] if folder is None else [folder]
        self._given = len(self.folders)
        self._here = ""
        self._depth = 0
        self._files = 0

    def file(self, path: Path, depth: int) -> Tree:
        root = elements(path)
        if root.tag not in _OBJECTS:
            raise SceneError(f"{path}, line {root.line}: <{root.tag}> is not a plugin")
        if path.parent not in self.folders:
            # Folders given by the user come last.
            self.folders.insert(max(len(self.folders) - self._given, 0), path.parent)
        before, self._here, self._depth = (self._here, self._depth), str(path), depth
        attributes = self._filled(root)
        version = attributes.get("version")
        if version is None:
            self._fail(root, "the outermost element must have a version")
        tree = self._object(root, attributes)
        if version.split(".")[0] in ("0", "1"):
            tree = _modern(tree)
        self._here, self._depth = before
        return tree

    def _object(self, element: Element, attributes: dict[str, str]) -> Tree:
        kind = "scene" if element.tag == "scene" else attributes.get("type")
        if kind is None:
            self._fail(element, f"<{element.tag}> must have a type")
        tree: Tree = {"type": kind}
        if "id" in attributes:
            tree["id"] = attributes["id"]
        for child in element.children:
            self._child(child, tree)
        return tree

    def _child(self, element: Element, tree: Tree) -> None:
        tag = element.tag
        # Values of parameters may occur in a default, too.
        attributes = self._filled(element)
        if tag == "default":
            name = self._need(element, attributes, "name")
            self.asked.add(name)
            self.values.setdefault(name, attributes.get("value", ""))
        elif tag == "path":
            folder = Path(self._need(element, attributes, "value"))
            self.folders.insert(0, folder if folder.is_absolute() else Path(self._here).parent / folder)
        elif tag == "include":
            self._include(element, attributes, tree)
        elif tag == "alias":
            target = {"type": "alias", "id": self._need(element, attributes, "id")}
            self._put(element, tree, self._need(element, attributes, "as"), target)
        else:
            key = attributes.get("name") or (attributes.get("id") if tag in _OBJECTS else None)
            value = self._value(element, attributes)
            self._put(element, tree, key, value)

    def _put(self, element: Element, tree: Tree, key: str | None, value: Any) -> None:
        if key is None:
            key = f"{element.tag} {len(tree)}"
        if key in tree:
            self._fail(element, f"{key!r} is given twice")
        tree[key] = value

    def _include(self, element: Element, attributes: dict[str, str], tree: Tree) -> None:
        if self._depth >= _MOST_INCLUDES:
            self._fail(element, f"files include each other more than {_MOST_INCLUDES} times")
        self._files += 1
        if self._files > _MOST_FILES:
            self._fail(element, f"more than {_MOST_FILES} files are included")
        name = self._need(element, attributes, "filename")
        path = resolve(name, [Path(self._here).parent, *self.folders])
        included = self.file(path, self._depth + 1)
        if included["type"] != "scene":
            return self._put(element, tree, included.get("id"), included)
        for key, value in included.items():
            if key not in ("type", "id"):
                # Keys with a space stand for elements without a name, which get a new key here.
                self._put(element, tree, None if " " in key else key, value)

    def _value(self, element: Element, attributes: dict[str, str]) -> Any:
        tag = element.tag
        if tag in _OBJECTS or (tag == "spectrum" and "type" in attributes):
            return self._object(element, attributes)
        if tag == "transform":
            # Mitsuba 0.6 spells it lookAt.
            steps = [(step.tag.lower(), self._filled(step)) for step in element.children]
            return of_elements(steps, lambda why: self._fail(element, why))
        if tag == "ref":
            return {"type": "ref", "id": self._need(element, attributes, "id")}
        if tag in ("vector", "point"):
            return self._vector(element, attributes)
        if tag == "spectrum" and "filename" in attributes:
            return {"type": "spectrum", "filename": attributes["filename"]}
        readers: dict[str, Callable[[str], Any]] = {
            "float": float,
            "integer": int,
            "boolean": _boolean,
            "string": str,
            "rgb": lambda text: {"type": "rgb", "value": _color(text)},
            "srgb": lambda text: {"type": "srgb", "color": _color(text)},
            "spectrum": lambda text: {"type": "spectrum", "value": _spectrum(text)},
        }
        if tag not in readers:
            self._fail(element, f"<{tag}> is not supported")
        text = attributes.get("value")
        if text is None:
            self._fail(element, f"<{tag}> must have a value")
        try:
            return readers[tag](text if tag == "string" else text.strip())
        except ValueError:
            self._fail(element, f"{text!r} is not a value of <{tag}>")

    def _vector(self, element: Element, attributes: dict[str, str]) -> list[float]:
        try:
            if "value" in attributes:
                return numbers(attributes["value"])
            return [float(attributes.get(axis, "0")) for axis in "xyz"]
        except ValueError:
            self._fail(element, f"<{element.tag}> must be numbers")

    def _filled(self, element: Element) -> dict[str, str]:
        """Return an element's attributes with ``$name`` replaced."""
        if not any("$" in text for text in element.attributes.values()):
            return element.attributes

        def value(found: re.Match[str]) -> str:
            if found[1] is None:
                return "$"
            # The longest known name, as text may follow it directly.
            for end in range(len(found[1]), 0, -1):
                if (text := self.values.get(found[1][:end])) is not None:
                    self.asked.add(found[1][:end])
                    return text + found[1][end:]
            self._fail(element, f"${found[1]} is not given, and has no <default>")

        return {name: re.sub(r"\\\$|\$(\w+)", value, text) for name, text in element.attributes.items()}

    def _need(self, element: Element, attributes: dict[str, str], name: str) -> str:
        if name not in attributes:
            self._fail(element, f"<{element.tag}> must have {name!r}")
        return attributes[name]

    def _fail(self, element: Element, why: str) -> NoReturn:
        raise SceneError(f"{self._here}, line {element.line}: {why}")


def elements(path: Path) -> Element:
    """Return the outermost element of an XML file.

    A file with a DOCTYPE is refused where that begins, before any entity of it is known: there are none to
    expand.

    Raises
    ------
    FileNotFoundError
        If the file is missing.
    ValueError
        If it is not XML, has a DOCTYPE, or nests too deep.
    """
    parser = expat.ParserCreate()
    open_ones: list[Element] = []
    roots: list[Element] = []

    def refuse(*_: Any) -> None:
        raise SceneError(f"{path}, line {parser.CurrentLineNumber}: a DOCTYPE is not allowed")

    def start(tag: str, attributes: dict[str, str]) -> None:
        element = Element(tag, attributes, parser.CurrentLineNumber)
        if len(open_ones) >= _MOST_LEVELS:
            raise SceneError(f"{path}, line {element.line}: elements nest more than {_MOST_LEVELS} deep")
        (open_ones[-1].children if open_ones else roots).append(element)
        open_ones.append(element)

    def end(_: str) -> None:
        open_ones.pop()

    parser.StartDoctypeDeclHandler = refuse
    parser.StartElementHandler = start
    parser.EndElementHandler = end
    with open(path, "rb") as file:
        try:
            parser.Parse(_COMMENT.sub(_undashed, file.read()), True)
        except expat.ExpatError as error:
            raise SceneError(f"{path} is not XML that can be read ({error})") from error
    return roots[0]


def _undashed(comment: re.Match[bytes]) -> bytes:
    """Return a comment without "--" in it, which Mitsuba reads although XML does not allow it."""
    return b"<!--" + comment[1].replace(b"-", b" ") + b"-->"


def resolve(name: str, folders: list[Path]) -> Path:
    """Return where a file is that a scene names: the first of the folders that has it.

    Raises
    ------
    FileNotFoundError
        If none has.
    """
    for folder in folders:
        if (path := folder / name).exists():
            return path
    raise FileNotFoundError(errno.ENOENT, "no such file", str(folders[0] / name if folders else name))


def numbers(text: str) -> list[float]:
    """Read numbers with commas or spaces between."""
    return [float(part) for part in text.replace(",", " ").split()]


def _color(text: str) -> Any:
    if text.startswith("#"):
        return text
    found = numbers(text)
    if len(found) not in (1, 3):
        raise ValueError
    return found[0] if len(found) == 1 else found


def _spectrum(text: str) -> Any:
    if ":" not in text:
        found = numbers(text)
        if len(found) != 1:
            raise ValueError
        return found[0]
    pairs = [part.split(":") for part in text.replace(",", " ").split()]
    return [(float(wavelength), float(value)) for wavelength, value in pairs]


def _boolean(text: str) -> bool:
    if text.lower() not in ("true", "false"):
        raise ValueError
    return text.lower() == "true"


def _text(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def _modern(tree: Tree) -> Tree:
    """Name parameters as version 2 does, where version 1 has them in camel case."""
    result: Tree = {}
    for key, value in tree.items():
        inner = _modern(value) if isinstance(value, dict) else value
        # An id belongs to the author of the scene and keeps its spelling.
        own = isinstance(value, dict) and value.get("type") != "ref" and value.get("id") == key
        result[key if own else _snake(key)] = inner
    if result.get("type") == "diffuse" and "diffuse_reflectance" in result:
        result["reflectance"] = result.pop("diffuse_reflectance")
    shift = [result.pop(name, 0.0) for name in ("uoffset", "voffset")]
    scale = [result.pop(name, 1.0) for name in ("uscale", "vscale")]
    if shift != [0.0, 0.0] or scale != [1.0, 1.0]:
        (a, b), (x, y) = scale, shift
        result["to_uv"] = [[a, 0.0, a * x], [0.0, b, b * y], [0.0, 0.0, 1.0]]
    return result


def _snake(name: str) -> str:
    return re.sub(r"(?<=[a-z0-9])([A-Z]+)", lambda found: "_" + found[1].lower(), name)
