"""Each check by itself, in the environment that runs nox; `nox --list` names them.

What follows `--` goes to the tool: `nox -s rust -- -p raywright-accel`, or
`nox -s python -- tests/python/cli/test_cli.py`.
`.ci/run` runs these sessions and no other checks.
"""

import shutil
import sys
from pathlib import Path

import nox

nox.options.sessions = ["lint", "rust", "python"]
nox.options.default_venv_backend = "none"


def run_module(session, *args, **how):
    """Run a module by the Python that runs nox."""
    session.run(sys.executable, "-m", *args, external=True, **how)


def cargo(session, *args, **how):
    """Run a command of cargo."""
    session.run("cargo", *args, external=True, **how)


@nox.session
def lint(session):
    """Check formats, style and types, and that every crate compiles without a warning."""
    cargo(session, "fmt", "--check")
    run_module(session, "ruff", "check", ".")
    run_module(session, "ruff", "format", "--check", ".")
    run_module(session, "mypy")
    strict = ["--", "--deny", "warnings"]
    cargo(session, "clippy", "--quiet", "--locked", "--workspace", "--all-targets", *strict)


@nox.session
def rust(session):
    """Run the Rust tests, with the crates that an installation has compiled."""
    cargo(session, "test", "--quiet", "--release", "--locked", *session.posargs)


@nox.session
def python(session):
    """Run the Python tests."""
    run_module(session, "pytest", *session.posargs)


@nox.session
def stubs(session):
    """Compare the stubs with the core that is installed."""
    run_module(session, "mypy.stubtest", "raywright._core")


@nox.session
def docs(session):
    """Make the pages and the references of both languages, with warnings as errors."""
    run_module(session, "pip", "install", "--quiet", "raywright[docs]")
    run_module(session, "sphinx", "--fail-on-warning", "--keep-going", "--quiet", "docs", "docs/_build/html")
    strict = {"RUSTDOCFLAGS": "--deny warnings"}
    cargo(session, "doc", "--quiet", "--locked", "--workspace", "--no-deps", env=strict)


@nox.session
def slow(session):
    """Run what a newcomer does not wait for: Rust tests with checks of overflow, and slow Python tests."""
    cargo(session, "test", "--quiet", "--locked")
    run_module(session, "pytest", "-m", "slow", *session.posargs)


@nox.session
def miri(session):
    """Interpret the tests of scalar lanes, loops, work and thread pools, which finds undefined behavior."""
    # Tree borrows, since crossbeam-epoch, under rayon, does not follow stacked borrows. Its threads outlive
    # the tests, and it keeps tags in pointers.
    flags = ["tree-borrows", "disable-isolation", "ignore-leaks", "permissive-provenance"]
    how = {
        "MIRIFLAGS": " ".join(f"-Zmiri-{flag}" for flag in flags),
        "PROPTEST_CASES": "8",
        # To find the names of a backtrace takes minutes.
        "RUST_BACKTRACE": "0",
    }
    tests = session.posargs or ["simd::", "parallel::", "work::", "workers::"]
    command = ["+nightly", "miri", "test", "--locked", "--package", "raywright-base", "--lib", "--", *tests]
    cargo(session, *command, env=how)


@nox.session
@nox.parametrize("language", ["python", "rust"])
def coverage(session, language):
    """Print the share of lines that tests run; `nox -s "coverage(language='rust')"` for one language."""
    if language == "python":
        run_module(session, "pip", "install", "--quiet", "coverage>=7", "pytest-cov>=5")
        run_module(session, "pytest", "--cov", "--cov-report=term:skip-covered", *session.posargs)
        return
    # Installs llvm-tools of the toolchain by itself.
    cargo(session, "install", "--quiet", "--locked", "cargo-llvm-cov")
    every = ["--workspace", "--exclude=raywright-python", "--exclude=raywright-benches"]
    cargo(session, "llvm-cov", "--release", "--locked", "--summary-only", *(session.posargs or every))


@nox.session
def outside(session):
    """Test the examples of docs/extending.md in a crate outside the tree, which sees public names only."""
    root, folder = Path.cwd(), Path(session.create_tmp())
    shutil.copytree(root / "tests" / "extending", folder / "tests" / "extending", dirs_exist_ok=True)
    for name in ("src", "docs"):
        (folder / name).mkdir(exist_ok=True)
    (folder / "src" / "lib.rs").write_text("")
    shutil.copy(root / "docs" / "extending.md", folder / "docs")
    manifest = '[package]\nname = "outside"\nedition = "2024"\n[workspace]\n[dependencies.raywright]\n'
    (folder / "Cargo.toml").write_text(f'{manifest}path = "{root.as_posix()}"\n')
    cargo(session, "test", "--quiet", "--manifest-path", str(folder / "Cargo.toml"))


@nox.session
def package(session):
    """Build the sdist, and test that it holds what the package is built and tested from."""
    run_module(session, "pip", "install", "--quiet", "maturin>=1.9,<2")
    shutil.rmtree("dist", ignore_errors=True)
    run_module(session, "maturin", "sdist", "--out", "dist")
    (sdist,) = Path("dist").glob("*.tar.gz")
    named = {"RAYWRIGHT_SDIST": str(sdist)}
    run_module(session, "pytest", "tests/python/house/test_package.py", "-k", "sdist", env=named)


@nox.session
def browser(session):
    """Test the viewer in a browser and in a notebook's cell, where there is a browser."""
    names = ["chromium", "chromium-headless-shell", "chromium-browser", "google-chrome"]
    if not any(map(shutil.which, names)):
        session.skip("there is no chromium")
    run_module(session, "pip", "install", "--quiet", "raywright[browser,widget]")
    tests = [
        f"tests/python/viewer/test_viewer_{name}.py" for name in ("browser", "error", "webgpu", "widget")
    ]
    run_module(session, "pytest", "--numprocesses=1", *tests)


@nox.session
def bench(session):
    """Time the kernels."""
    cargo(session, "bench", "--package", "raywright-benches", *session.posargs)
