"""Docstrings are numpydoc's: public callables have all sections, and an example that runs as a doctest."""

import ast
import doctest
import functools
import inspect
import os
import re
import sys
from types import ModuleType

import numpy as np
import pytest

import raywright as rw
from raywright.compat import open3d, pyvista, trimesh_proximity, trimesh_ray

# In numpydoc's order.
SECTIONS = (
    "Parameters", "Attributes", "Returns", "Yields", "Raises", "Warns",
    "See Also", "Notes", "References", "Examples",
)  # fmt: skip
# Callables without all of their sections. This may only shrink.
UNFINISHED: set[str] = set()


def members(name, value):
    """Yield the public objects under a name: itself, its members (inherited ones too), its contents."""
    yield name, value
    if inspect.isclass(value):
        found = set()
        for base in value.__mro__:
            if base.__module__.startswith("raywright"):
                for own, member in vars(base).items():
                    if own in found:
                        continue
                    found.add(own)
                    inner = getattr(
                        member, "__func__", getattr(member, "fget", getattr(member, "func", member))
                    )
                    if not own.startswith("_") and inspect.isroutine(inner):
                        yield f"{name}.{own}", inner
    if isinstance(value, ModuleType):
        for own in value.__all__:
            yield from members(f"{name}.{own}", getattr(value, own))


APART = {module.__name__: module for module in (open3d, pyvista, trimesh_proximity, trimesh_ray)}
PUBLIC = {
    full: value
    for name, top in [*((name, getattr(rw, name)) for name in rw.__all__), *APART.items()]
    for full, value in members(name, top)
    if getattr(value, "__doc__", None) and getattr(type(value), "__doc__", None) != value.__doc__
}
PROPERTIES = {
    member.fget if isinstance(member, property) else member.func
    for value in PUBLIC.values()
    if inspect.isclass(value)
    for base in value.__mro__
    for member in vars(base).values()
    if isinstance(member, property | functools.cached_property)
}
# One name for each, though methods are inherited.
CALLABLES = {}
for full, value in PUBLIC.items():
    if callable(value) and value not in PROPERTIES and value not in CALLABLES.values():
        CALLABLES[full] = value
WITH_EXAMPLES = {full: value for full, value in CALLABLES.items() if ">>>" in value.__doc__}


def sections(text):
    """Return the lines of each section of a docstring, by its heading; those before the first by None."""
    found = {None: []}
    lines = text.splitlines()
    last, skip = None, False
    for line, after in zip(lines, [*lines[1:], ""], strict=True):
        if skip:
            skip = False
        elif re.fullmatch(r"-+", after) and line:
            if len(after) != len(line):
                raise ValueError(f"{line} is not underlined as long as it is")
            if line in found:
                raise ValueError(f"there are two {line}")
            last, skip = line, True
            found[last] = []
        else:
            found[last].append(line)
    return found


def test_much_is_public():
    assert len(PUBLIC) > 250
    assert len(CALLABLES) > 220
    assert {
        "Plane",
        "Scene.intersect",
        "query.Hits.position",
        "report.Table.plot",
        "scenes.cornell_box",
    } <= set(PUBLIC)


def trouble_with(text):
    """Say what is wrong with the sections of a docstring; None if nothing is."""
    try:
        found = sections(text)
    except ValueError as error:
        return str(error)
    headings = [heading for heading in found if heading is not None]
    if headings != [heading for heading in SECTIONS if heading in headings]:
        return f"sections are not in order, or not numpydoc's: {headings}"
    for heading, lines in found.items():
        # Remains of a heading without its own line: within a text, or without the dashes under it.
        for line in lines:
            # Examples may print tables.
            if (heading != "Examples" and re.search(r"-{4,}", line)) or line.strip() in SECTIONS:
                return f"a heading within {heading}: {line}"
        if not any(lines):
            return f"{heading} is empty"
    first = found[None]
    return None if first[0].strip() and not any(first[1:2]) else "there is no first line that stands alone"


def test_sections_are_numpydocs():
    found = {name: trouble_with(inspect.getdoc(value)) for name, value in PUBLIC.items()}
    assert {name: told for name, told in found.items() if told} == {}


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("One line.\n\nNotes ----- Joined to the\ntext.", "a heading within None: Notes ----- Joined to the"),
        ("One line.\n\nNotes\n\nNot underlined.", "a heading within None: Notes"),
        ("One line.\n\nNotes\n----\nToo short.", "Notes is not underlined as long as it is"),
        ("One line.\n\nNotes\n-----\nOne.\n\nNotes\n-----\nTwo.", "there are two Notes"),
        ("One line.\n\nNotes\n-----\nA.\n\nRaises\n------\nB.", "sections are not in order"),
        ("One line.\n\nReason\n------\nA.", "sections are not in order, or not numpydoc's: ['Reason']"),
        ("One line.\n\nReturns\n-------\n\nRaises\n------\nB.", "Returns is empty"),
        ("Two lines\ntogether.", "there is no first line that stands alone"),
        ("One line.\n\nMore.\n\nReturns\n-------\nfloat\n    x\n\nNotes\n-----\nB.", None),
    ],
)  # fmt: skip
def test_what_is_wrong_is_seen(text, told):
    found = trouble_with(text)
    assert found is None if told is None else found.startswith(told)


def test_parameters_are_there():
    wrong = {}
    for name, value in PUBLIC.items():
        if not callable(value):
            continue
        lines = sections(inspect.getdoc(value)).get("Parameters", [])
        told = [line.partition(" : ")[0] for line in lines if line and not line.startswith(" ")]
        told = [one.strip().lstrip("*") for line in told for one in line.split(",")]
        strangers = set(told) - set(inspect.signature(value).parameters) if told else set()
        if strangers or len(told) > len(set(told)):
            wrong[name] = told
    assert wrong == {}


def missing(value):
    """Return the sections that a public callable should have, and has not."""
    found = set(sections(inspect.getdoc(value)))
    needed = {"Examples"}
    signature = None
    try:
        signature = inspect.signature(value)
    except ValueError:
        # A class of the core that is not made from Python.
        assert inspect.isclass(value)
    taken = {name for name in (signature.parameters if signature else ()) if name not in ("self", "cls")}
    if inspect.isclass(value):
        # Results and abstract classes are not made by users: they may list attributes, or neither.
        found |= {"Parameters"} if "Attributes" in found or "Raises" not in found else set()
    elif signature.return_annotation not in (None, "None") and not {"Returns", "Yields"} & found:
        needed.add("Returns")
    if taken:
        needed.add("Parameters")
    return sorted(needed - found)


def test_callables_have_their_sections():
    lacking = {name: gaps for name, value in CALLABLES.items() if (gaps := missing(value))}
    assert {name: gaps for name, gaps in lacking.items() if name not in UNFINISHED} == {}
    # A name leaves the list when it is finished.
    assert set(lacking) >= UNFINISHED


def exists(name, places):
    """Return whether a name with dots leads from one of some modules to a thing, or to a field of a class."""
    for value in places:
        for part in name.split("."):
            fields = getattr(value, "__annotations__", {}) if inspect.isclass(value) else {}
            value = getattr(value, part, fields.get(part))
        if value is not None:
            return True
    return False


def test_what_is_seen_also_exists():
    modules = [value for value in PUBLIC.values() if isinstance(value, ModuleType)]
    strangers = {}
    for full, value in CALLABLES.items():
        home = value.__module__.removesuffix(".installation")
        places = [rw, *(module for module in modules if home.startswith(module.__name__))]
        lines = sections(inspect.getdoc(value)).get("See Also", ())
        names = [name.strip() for line in lines if line for name in line.partition(" : ")[0].split(",")]
        strangers |= {f"{full}: {name}": "is not there" for name in names if not exists(name, places)}
    assert strangers == {}


def imports(source):
    """Return the names of modules that a piece of code imports."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.module


@functools.cache
def why_no_device():
    """Return why there is no graphics processor; an empty text if there is one."""
    try:
        rw.Gpu()
    except (ImportError, RuntimeError) as missing:
        return str(missing)
    return ""


@pytest.mark.parametrize("name", WITH_EXAMPLES)
def test_examples_run(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(os.environ, "MPLBACKEND", "agg")
    globs = {"np": np, "rw": rw}
    test = doctest.DocTestParser().get_doctest(inspect.getdoc(WITH_EXAMPLES[name]), globs, name, None, None)
    for example in test.examples:
        for module in imports(example.source):
            pytest.importorskip(module, exc_type=ImportError)
    if any("rw.Gpu(" in example.source for example in test.examples) and (reason := why_no_device()):
        pytest.skip(reason)
    told = []
    failed = doctest.DocTestRunner().run(test, out=told.append).failed
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")
    assert not failed, "".join(told)


def test_a_wrong_example_is_seen():
    test = doctest.DocTestParser().get_doctest(">>> 1 + 1\n3\n", {}, "wrong", None, None)
    assert doctest.DocTestRunner().run(test, out=lambda _: None).failed == 1
