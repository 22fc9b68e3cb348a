"""What is shipped: how large it is, what the sdist holds, and that processors of 2008 run it.

`.ci/package` builds a wheel and an sdist, and names them in ``RAYWRIGHT_WHEEL`` and ``RAYWRIGHT_SDIST``.
Without these, size is that of the installed package, packed as wheels are.
"""

import os
import platform
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import zipfile
from pathlib import Path

import pytest

import raywright as rw
from raywright.viewer.texts import MODULES

ROOT = Path(__file__).parents[3]
MOST_BYTES = 6_700_000
QEMU = shutil.which("qemu-x86_64")

# Rays at corners and between them, with a digest of their results' bits. The rays use no sine: the last bits
# of numpy's own depend on the processor.
ANSWERS = """
import hashlib, numpy as np, raywright as rw
rng = np.random.default_rng(0)
soup = rw.Mesh(rng.uniform(-1, 1, (900, 3)), np.arange(900).reshape(300, 3))
shapes = [soup, rw.Torus((3, 0, 0), (0, 0, 1), 1.0, 0.3)]
directions = np.concatenate([soup.vertices, rng.uniform(-4, 4, (2000, 3))]) - (0, 0, 6)
digest = hashlib.sha256()
for precision in ("single", "double"):
    scene = rw.Scene(shapes, precision=precision)
    hits = scene.intersect((0, 0, 6), directions)
    assert hits.hit.any() and not hits.hit.all()
    blocked, count = (ask((0, 0, 6), directions) for ask in (scene.occluded, scene.count))
    for array in (hits.t, hits.primitive, hits.uv, blocked, count):
        digest.update(np.ascontiguousarray(array).tobytes())
print(rw.simd(), digest.hexdigest())
"""


def test_wheel_is_small(tmp_path):
    wheel = os.environ.get("RAYWRIGHT_WHEEL")
    if wheel is None:
        folder = Path(rw.__file__).parent
        wheel = tmp_path / "raywright.whl"
        with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as packed:
            for path in folder.rglob("*"):
                if path.is_file() and "__pycache__" not in path.parts:
                    packed.write(path, path.relative_to(folder.parent))
    assert 100_000 < os.path.getsize(wheel) < MOST_BYTES


@pytest.mark.skipif("RAYWRIGHT_WHEEL" not in os.environ, reason="no wheel is named")
def test_wheel_is_for_all_pythons_from_3_10_and_holds_the_package_alone():
    """A free-threaded Python has a wheel of its own: it cannot load the stable interface."""
    wheel = Path(os.environ["RAYWRIGHT_WHEEL"])
    own = "cp{}{}".format(*sys.version_info)
    is_free = sysconfig.get_config_var("Py_GIL_DISABLED")
    assert (f"-{own}-{own}t-" if is_free else "-cp310-abi3-") in wheel.name
    names = zipfile.ZipFile(wheel).namelist()
    assert {"raywright/__init__.py", "raywright/_core.pyi", "raywright/py.typed"} <= set(names)
    assert {f"raywright/viewer/page.{kind}" for kind in ("html", "css", "js")} <= set(names)
    parts = {
        path.name for path in (ROOT / "python/raywright/viewer").iterdir() if path.suffix in (".js", ".wgsl")
    }
    assert {f"raywright/viewer/{part}" for part in {*parts, *MODULES, "widget.js"}} <= set(names)
    kernels = ("trace", "closest", "occluded", "probe", "shading", "walk", "paths")
    assert {f"raywright/gpu/{kernel}.wgsl" for kernel in kernels} <= set(names)
    assert sum(name.endswith((".so", ".pyd")) for name in names) == 1
    tops = {name.split("/")[0].removesuffix(".dist-info").split("-")[0] for name in names}
    assert tops <= {"raywright", "raywright.libs"}


@pytest.mark.skipif("RAYWRIGHT_SDIST" not in os.environ, reason="no sdist is named")
def test_sdist_holds_what_it_is_built_and_tested_from():
    with tarfile.open(os.environ["RAYWRIGHT_SDIST"]) as packed:
        names = {name.split("/", 1)[1] for name in packed.getnames()}
    wanted = {"pyproject.toml", "Cargo.toml", "Cargo.lock", "README.md", "LICENSE-MIT", "LICENSE-APACHE"}
    assert wanted <= names
    for folder in ("rust", "python/raywright", "tests", "docs", "examples"):
        mine = {
            path.relative_to(ROOT).as_posix()
            for kind in ("*.rs", "*.py", "*.pyi", "*.md", "*.html", "*.css", "*.js", "*.wgsl")
            for path in (ROOT / folder).rglob(kind)
        }
        # The scripts that build the pages are useless without the repository.
        assert {name for name in mine if not name.startswith("docs/") or name.endswith(".md")} <= names
    assert not [name for name in names if name.endswith((".so", ".pyd", ".pyc"))]


@pytest.mark.slow
@pytest.mark.skipif(
    QEMU is None or sys.platform != "linux" or platform.machine() != "x86_64",
    reason="needs qemu-x86_64, on Linux and x86-64",
)
def test_processors_without_avx_give_the_same_answers():
    told = [
        subprocess.run(
            [*command, sys.executable, "-c", ANSWERS],
            capture_output=True,
            text=True,
            check=True,
            timeout=300,
            env={name: value for name, value in os.environ.items() if name != "RAYWRIGHT_SIMD"},
        ).stdout.split()
        for command in ([], [QEMU, "-cpu", "Nehalem"])
    ]
    (level, native), (old_level, old) = told
    assert old_level == "sse2"
    assert level in ("sse2", "avx2", "avx512")
    assert native == old
