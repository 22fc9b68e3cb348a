"""Importing the package imports numpy and its core; a name is imported when it is first used."""

import ast
import importlib
import importlib.metadata
import os
import pkgutil
import platform
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import raywright as rw


def run(code):
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    return done.stdout


def test_import_brings_in_the_core_and_nothing_else():
    code = "import numpy, sys; before = set(sys.modules); import raywright; print(*set(sys.modules) - before)"
    assert set(run(code).split()) - {"__future__"} == {"raywright", "raywright._core"}


def imported(use):
    """Return the names of the modules that a use of the package imports beyond numpy."""
    code = f"import numpy, sys; before = set(sys.modules); {use}; print(*set(sys.modules) - before)"
    return set(run(code).split())


@pytest.mark.parametrize(
    ("use", "unused"),
    [
        ("rw.Mesh", "accelerators cameras integrators query rendering scene scenes"),
        ("rw.Scene", "cli compat exchange gpu integrators mesh_files rendering scene_files scenes viewer"),
        ("rw.render", "cli compat gpu mesh_files scene_files scenes viewer"),
    ],
)
def test_a_name_imports_what_it_needs(use, unused):
    new = imported(f"import raywright as rw; {use}")
    assert not {f"raywright.{room}" for room in unused.split()} & new
    assert {name.split(".")[0] for name in new} - set(sys.stdlib_module_names) <= {"raywright", "numpy"}


def test_queries_do_not_bring_in_more():
    code = (
        "import sys, raywright as rw; s, c = rw.scenes.cornell_box(rw.scenes.torus_knot(), 8, 8);"
        "s.intersect(*c.rays()); rw.render(s, c, samples=1, progress=False);"
        "print(*{'trimesh', 'PIL', 'tqdm', 'OpenEXR'} & set(sys.modules))"
    )
    assert run(code).split() == []


def test_queries_leave_to_others_what_few_need():
    new = imported("import raywright as rw; rw.Scene(rw.Sphere((0, 0, 0), 1)).occluded((0, 0, 5), (0, 0, 1))")
    assert not new & {
        *("logging", "hashlib", "json", "concurrent.futures", "asyncio", "email", "http", "socket"),
        *("subprocess", "tempfile", "unittest", "xml", "numpy.ma"),
    }


def test_what_type_checkers_read_is_what_is_imported():
    tree = ast.parse(Path(rw.__file__).read_text(encoding="utf-8"))
    read = {
        name.name: node.module or name.name
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and node.level
        for name in node.names
    }
    assert read == {"_core": "_core"} | {name: name for name in rw.__all__} | rw._MODULES


def test_subpackages_are_there_with_what_is_public_of_them():
    code = (
        "import raywright as rw; print(rw.rendering.image.Image is rw.Image, rw.textures.illuminants['D65'] "
        "is"
        " not None, rw.materials.glasses['SF10'] is not None, rw.scene.scene.Scene is rw.Scene)"
    )
    assert run(code).split() == ["True"] * 4
    # A name in both would change its meaning with what has been imported.
    rooms = {module.name for module in pkgutil.iter_modules(rw.__path__)}
    modules = {name for name in rw.__all__ if isinstance(getattr(rw, name), ModuleType)}
    assert rooms & set(rw.__all__) == modules


@pytest.mark.parametrize("name", ["Sceen", "_nothing", "compat"])
def test_what_is_not_there_is_told(name):
    done = subprocess.run(
        [sys.executable, "-c", f"import raywright; raywright.{name}"], capture_output=True, text=True
    )
    assert f"AttributeError: module 'raywright' has no attribute '{name}'" in done.stderr


def test_threads_that_use_the_package_first_see_the_same():
    code = (
        "import threading, raywright as rw; names = rw.__all__; found = []; b = threading.Barrier(4);"
        "use = lambda: (b.wait(), found.append([getattr(rw, n) for n in names]));"
        "threads = [threading.Thread(target=use) for _ in range(4)];"
        "[t.start() for t in threads]; [t.join() for t in threads];"
        "print(len(found), all(a is b for some in found for a, b in zip(some, found[0], strict=True)))"
    )
    assert run(code).split() == ["4", "True"]


def test_every_public_name_is_there_and_documented():
    assert len(rw.__all__) == len(set(rw.__all__))
    for name in rw.__all__:
        assert getattr(rw, name).__doc__, name


@pytest.mark.parametrize(
    "used", ["", "raywright.load, raywright.report, raywright.view; from raywright import *; "]
)
def test_dir_is_what_is_public(used):
    told = run(f"import raywright; {used}print(*dir(raywright))").split()
    assert len(told) == len(set(told))
    # Lazy imports are included, and no submodule is.
    assert {name for name in told if not (name.startswith("__") and name.endswith("__"))} == set(rw.__all__)
    assert {"__all__", "__doc__", "__file__", "__name__", "__version__"} <= set(told)
    assert told == sorted(told)


def packages():
    """Yield the packages below the top that say which of their names are public."""
    for found in pkgutil.walk_packages(rw.__path__, "raywright."):
        if found.ispkg and hasattr(module := importlib.import_module(found.name), "__all__"):
            yield pytest.param(module, id=found.name)


@pytest.mark.parametrize("module", list(packages()))
def test_dir_of_a_package_is_what_is_public(module):
    told = dir(module)
    # No modules that it imports, no helpers, no submodules.
    assert [name for name in told if not name.startswith("__")] == sorted(module.__all__)
    assert {"__all__", "__doc__", "__file__", "__name__"} <= set(told) <= {*vars(module), *module.__all__}


def test_every_public_package_says_what_is_public():
    apart = {"raywright.cli", "raywright.scene_files", "raywright.mesh_files", "raywright.io.exr"}
    names = {found.name for found in pkgutil.walk_packages(rw.__path__, "raywright.") if found.ispkg}
    assert {package.id for package in packages()} == names - apart


def test_the_version_is_that_of_the_package_and_of_the_crate():
    cargo = Path(__file__).parents[3] / "Cargo.toml"
    crate = re.search(r'^version = "(.*)"$', cargo.read_text(encoding="utf-8"), re.MULTILINE)[1]
    assert rw.__version__ == crate == importlib.metadata.version("raywright")


def test_simd_tells_the_level():
    assert rw.simd() in ("scalar", "neon", "sse2", "avx2", "avx512")


LEAST = "neon" if platform.machine().lower() in ("aarch64", "arm64") else "sse2"


def test_simd_can_be_forced():
    code = "import raywright; print(raywright.simd())"
    told = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
        env={**os.environ, "RAYWRIGHT_SIMD": LEAST},
    )
    assert told.stdout.strip() == LEAST
