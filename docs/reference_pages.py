"""A Sphinx extension that writes the reference: a page for each public name, and one for each part.

A name of ``raywright.__all__`` belongs to the module or subpackage that it comes from, whose docstring heads
the part's page; modules among the names are parts themselves. So a new name needs nothing here.
"""

import inspect
import sys
from collections import defaultdict
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import raywright
from raywright.compat import open3d, pyvista, trimesh_proximity, trimesh_ray

# Modules that users import by themselves.
_APART = {
    "open3d": open3d,
    "pyvista": pyvista,
    "trimesh_proximity": trimesh_proximity,
    "trimesh_ray": trimesh_ray,
}
# Where members of a class come from that is not the package's own business.
_STRANGERS = "tuple, dict, object, Exception, ABC, Generic"
_CORE = "the core"
_HEADINGS = {
    "gpu": "Graphics processors",
    "io": "Files",
    "query": "What rays and points find",
    "rendering": "Pictures",
    "scene": "Scenes",
    "scene_files": "Scene files",
}


def parts() -> dict[str, tuple[str, str, list[str]]]:
    """Return the parts by file name, each with a heading, a text, and full names."""
    grouped: dict[str, list[str]] = defaultdict(list)
    found: dict[str, tuple[str, str, list[str]]] = {}
    named = {name: getattr(raywright, name) for name in raywright.__all__}
    for name, value in sorted((named | _APART).items(), key=lambda item: item[0].lower()):
        if isinstance(value, ModuleType):
            # Each thing once, by the shortest name that it has.
            own = [one for one in value.__all__ if named.get(one) is not getattr(value, one)]
            brought = [one for one in named if name != one and _home(one, named[one]) == name]
            names = [f"raywright.{one}" for one in brought] + [f"{value.__name__}.{one}" for one in own]
            found[name] = (value.__name__, _text(value), names)
        elif _home(name, value) not in named:
            grouped[_home(name, value)].append(f"raywright.{name}")
    for home, names in grouped.items():
        module = None if home == _CORE else import_module(f"raywright.{home}")
        heading = _HEADINGS.get(home, home.replace("_", " ").capitalize())
        found[f"about_{home.replace(' ', '_')}"] = (heading, _text(module), names)
    return found


def _home(name: str, value: Any) -> str:
    """Return the first module under the package that a thing comes from."""
    origin = getattr(value, "__module__", None)
    if origin is None:
        # Constants do not know where they come from: it is the module that has them and has the longest name.
        having = (path for path, module in sys.modules.items() if vars(module).get(name) is value)
        origin = max((path for path in having if path.startswith("raywright.")), key=len, default="")
    names = origin.split(".")
    return names[1] if names[0] == "raywright" and len(names) > 1 and names[1] != "_core" else _CORE


def _text(module: ModuleType | None) -> str:
    if module is None:
        return "Names of the compiled part of the package."
    return inspect.getdoc(module) or ""


def _value(name: str) -> Any:
    module, _, last = name.rpartition(".")
    return getattr(import_module(module), last)


def _kind(name: str) -> str:
    value = _value(name)
    return "class" if inspect.isclass(value) else "function" if inspect.isroutine(value) else "data"


def _page_of(name: str) -> str:
    """Return the file of a name, which some file systems could not tell from one in other letters."""
    return f"{_kind(name)}_{name}"


def _page(name: str) -> str:
    """Return the page of a name."""
    module, _, last = name.rpartition(".")
    kind = _kind(name)
    lines = [_underlined(last, "="), f".. py:currentmodule:: {module}", "", f".. auto{kind}:: {name}"]
    if kind == "class":
        lines += ["   :members:", f"   :inherited-members: {_STRANGERS}"]
    return "\n".join([*lines, ""])


def _part(heading: str, text: str, names: list[str]) -> str:
    """Return the page of a part: its text, and its names with the first lines of their docstrings."""
    lines = [_underlined(heading, "="), text, ""]
    for name in names:
        summary = "" if _kind(name) == "data" else (inspect.getdoc(_value(name)) or "").partition("\n")[0]
        lines += [f":py:obj:`{name.rpartition('.')[2]} <{name}>`", f"    {summary or 'Data.'}", ""]
    return "\n".join(
        [*lines, ".. toctree::", "   :hidden:", "", *(f"   {_page_of(name)}" for name in names), ""]
    )


def _underlined(text: str, line: str) -> str:
    return f"{text}\n{line * len(text)}\n"


def write(folder: Path) -> None:
    """Write the pages, and remove those of names that are no more."""
    pages = parts()
    folder.mkdir(exist_ok=True)
    texts = {file: _part(heading, text, names) for file, (heading, text, names) in pages.items()}
    texts |= {_page_of(name): _page(name) for _, _, names in pages.values() for name in names}
    index = [
        _underlined("Reference", "="),
        "Every public name, part by part, each on a page with an example.",
        "In the examples, ``np`` is numpy and ``rw`` is raywright.",
        "",
    ]
    for file, (_, _, names) in sorted(pages.items(), key=lambda page: page[1][0].removeprefix("raywright.")):
        index.append(f":doc:`{file}`")
        links = (f":py:obj:`{name.rpartition('.')[2]} <{name}>`" for name in names)
        index.append(f"    {', '.join(links)}\n")
    index += [".. toctree::", "   :hidden:", "", *(f"   {file}" for file in sorted(pages))]
    texts["index"] = "\n".join([*index, ""])
    for old in folder.glob("*.rst"):
        if old.stem not in texts:
            old.unlink()
    for file, text in texts.items():
        path = folder / f"{file}.rst"
        # An unchanged page keeps its time, so that it is not read anew.
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


def _skipped(_app: Any, _what: str, _name: str, value: Any, skip: bool, _options: Any) -> bool | None:
    """Leave out what named tuples say of their fields, which their own docstrings say better."""
    return True if str(getattr(value, "__doc__", "")).startswith("Alias for field number") else None


def setup(app: Any) -> dict[str, bool]:
    """Write the reference before pages are read."""
    app.connect("builder-inited", lambda app: write(Path(app.srcdir) / "reference"))
    app.connect("autodoc-skip-member", _skipped)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
