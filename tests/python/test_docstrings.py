"""Docstrings are as numpydoc reads them: sections begin with underlined headings, and name what is there."""

import inspect
import re
from types import ModuleType

import pytest

import raywright as rw
from raywright.compat import open3d, pyvista, trimesh_proximity, trimesh_ray

# In the order that they have.
SECTIONS = ("Parameters", "Attributes", "Returns", "Yields", "Raises", "Warns", "Notes", "References")


def members(name, value):
    """Yield what is public by its full name: a thing, and of a class what it has of its own or inherits."""
    yield name, value
    if inspect.isclass(value):
        for base in value.__mro__:
            if base.__module__.startswith("raywright"):
                for own, member in vars(base).items():
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
    assert {"Plane", "Scene.intersect", "Hits.position", "report.Table.plot", "scenes.cornell_box"} <= set(
        PUBLIC
    )


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
            if re.search(r"-{4,}", line) or line.strip() in SECTIONS:
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
