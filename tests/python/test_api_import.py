"""Importing the package imports numpy and nothing else, and soon."""

import importlib.metadata
import os
import platform
import re
import statistics
import subprocess
import sys
from pathlib import Path

import pytest

import raywright as rw


def run(code):
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    return done.stdout


def test_import_brings_in_numpy_and_nothing_else():
    code = "import numpy, sys; before = set(sys.modules); import raywright; print(*set(sys.modules) - before)"
    new = {name.split(".")[0] for name in run(code).split()}
    assert new - set(sys.stdlib_module_names) <= {"raywright", "numpy"}
    assert "raywright" in new


def test_queries_do_not_bring_in_more():
    code = (
        "import sys, raywright as rw; s, c = rw.scenes.cornell_box(rw.scenes.torus_knot(), 8, 8);"
        "s.intersect(*c.rays()); rw.render(s, c, samples=1, progress=False);"
        "print(*{'trimesh', 'PIL', 'tqdm', 'OpenEXR'} & set(sys.modules))"
    )
    assert run(code).split() == []


def test_import_leaves_to_others_what_few_need():
    code = (
        "import sys, numpy; before = set(sys.modules); import raywright;"
        "print(*{'logging', 'hashlib', 'json', 'concurrent.futures', 'asyncio', 'email', 'http', 'socket',"
        " 'subprocess', 'tempfile', 'unittest', 'xml'} & (set(sys.modules) - before))"
    )
    assert run(code).split() == []


def test_import_takes_less_than_two_of_numpy():
    # Of the process, which waits for nothing, and beside numpy in the same process: machines differ.
    code = (
        "import time; a = time.process_time(); import numpy; b = time.process_time(); import raywright;"
        "print((time.process_time() - b) / (b - a))"
    )
    assert statistics.median(float(run(code)) for _ in range(5)) < 2


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
    # What waits to be imported is among it, and nothing that the package is made of.
    assert {name for name in told if not (name.startswith("__") and name.endswith("__"))} == set(rw.__all__)
    assert {"__all__", "__doc__", "__file__", "__name__", "__version__"} <= set(told)
    assert told == sorted(told)


def test_the_version_is_that_of_the_package_and_of_the_crate():
    cargo = Path(__file__).parents[2] / "Cargo.toml"
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
