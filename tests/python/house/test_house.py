"""The package's floors: every import leads to a lower one, and none goes round in a circle."""

import ast
from collections.abc import Iterator
from pathlib import Path

import raywright

PACKAGE = Path(raywright.__file__).parent
# Rooms, folders or files of the root, from the ground up; those of one floor do not depend on each other.
FLOORS = [
    {"_core", "debug_log", "foreign_arrays", "html_tables", "public_names"},
    {"arrays", "locks"},
    {"descriptions"},
    {"accelerators", "cameras", "io"},
    {"textures"},
    {"media"},
    {"lights", "materials"},
    {"shapes"},
    {"mesh_files", "query"},
    {"scene"},
    {"exchange", "gpu", "measure"},
    {"integrators", "scenes"},
    {"rendering"},
    {"compat", "report", "scene_files", "viewer"},
    {"cli"},
    {"__init__", "__main__"},
]
FLOOR = {room: floor for floor, rooms in enumerate(FLOORS) for room in rooms}


def parts_of(file: Path) -> tuple[str, ...]:
    """The module of a file, from the package's root on; a folder is what its __init__ holds."""
    inner = file.relative_to(PACKAGE).with_suffix("").parts
    return inner[:-1] if inner[-1] == "__init__" and len(inner) > 1 else inner


MODULES = {parts_of(file): file for file in PACKAGE.rglob("*.py")} | {("_core",): PACKAGE / "_core.pyi"}


def imported(file: Path) -> Iterator[tuple[str, ...]]:
    """The package's modules that a file imports: at its top, within functions, and for its types."""
    inside = file.relative_to(PACKAGE).parts[:-1]
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            assert not any(name.name.split(".")[0] == "raywright" for name in node.names), (
                f"{file}: import is absolute"
            )
        elif isinstance(node, ast.ImportFrom) and node.level:
            base = (
                (*inside[: len(inside) - node.level + 1], *(node.module or "").split("."))
                if node.module
                else (inside[: len(inside) - node.level + 1])
            )
            for name in node.names:
                found = (*base, name.name)
                yield found if found in MODULES else base or ("__init__",)


ARROWS = {
    (module, to)
    for module, file in MODULES.items()
    if file.suffix == ".py"
    for to in imported(file)
    if to != module
}


def test_every_room_has_a_floor() -> None:
    assert {module[0] for module in MODULES} == set(FLOOR)


def test_imports_lead_down() -> None:
    upward = {
        f"{'.'.join(a)} -> {'.'.join(b)}" for a, b in ARROWS if a[0] != b[0] and FLOOR[a[0]] <= FLOOR[b[0]]
    }
    assert not upward


def test_no_file_needs_itself() -> None:
    """Within a room, too, files come one after the other (Kahn's order)."""
    left = set(ARROWS)
    while bare := {b for _, b in left} - {a for a, _ in left}:
        left = {(a, b) for a, b in left if b not in bare}
    # The remaining modules lead into a circle; those without an arrow to them only lead there.
    while out := {a for a, _ in left} - {b for _, b in left}:
        left = {(a, b) for a, b in left if a not in out}
    assert not left


def test_imports_are_read() -> None:
    """Of each way to import there is one that is known."""
    known = {
        "cli": "scene_files.load",
        "rendering.run_render": "rendering.executor",
        "scene.scene": "_core",
        "scene.instance": "shapes.mesh",
        "__init__": "viewer",
    }
    assert {(tuple(a.split(".")), tuple(b.split("."))) for a, b in known.items()} <= ARROWS


def test_tests_mirror_the_package() -> None:
    """Tests lie in folders named as the package's, or in `house`, and no two files have one name."""
    tests = Path(__file__).parents[1]
    rooms = {file.parent.name for file in PACKAGE.glob("*/__init__.py")}
    assert {file.parent.name for file in tests.glob("*/test_*.py")} <= rooms | {"house"}
    assert len({file.name for file in tests.rglob("*.py")}) == len(list(tests.rglob("*.py")))
