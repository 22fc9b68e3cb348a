"""wgpu is a range of versions: what raywright calls of it is checked before it is called."""

import ast
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

import raywright as rw
from raywright.gpu.wgpu_api import CALLED, TESTED, changes_named, imported_wgpu

FOLDER = Path(rw.__file__).parent / "gpu"
EVERY = [(owner, name) for owner, names in CALLED.items() for name in names]


def stand_in(without=()):
    """A module like wgpu that has what is called, but for some of it."""
    owners = {
        owner: SimpleNamespace(**{name: None for name in names if (owner, name) not in without})
        for owner, names in CALLED.items()
    }
    return SimpleNamespace(__version__="9.8.7", **owners)


@pytest.mark.parametrize("gone", EVERY, ids=".".join)
def test_each_thing_that_is_gone_is_named_with_the_version(monkeypatch, gone):
    monkeypatch.setitem(sys.modules, "wgpu", stand_in([gone]))
    with pytest.raises(ImportError, match=rf"^wgpu 9\.8\.7 lacks {gone[0]}\.{gone[1]}; ") as told:
        rw.Gpu()
    assert f"pip install 'wgpu>={TESTED[0]},<={TESTED[1]}'" in str(told.value)


def test_all_that_is_gone_is_named_in_one_line(monkeypatch):
    monkeypatch.setitem(sys.modules, "wgpu", SimpleNamespace())
    with pytest.raises(ImportError, match=r"^wgpu of unknown version lacks") as told:
        rw.Gpu()
    assert all(".".join(each) in str(told.value) for each in EVERY)
    assert "\n" not in str(told.value)


def test_a_module_that_has_all_of_it_is_taken(monkeypatch):
    module = stand_in()
    monkeypatch.setitem(sys.modules, "wgpu", module)
    assert imported_wgpu() is module


def test_a_library_that_cannot_be_loaded_is_told_apart_from_one_that_is_missing(monkeypatch, tmp_path):
    (tmp_path / "wgpu.py").write_text("raise OSError('libwgpu_native.so: cannot open')")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "wgpu", raising=False)
    with pytest.raises(ImportError, match=r"^wgpu is installed but cannot be loaded: libwgpu_native"):
        rw.Gpu()
    (tmp_path / "wgpu.py").write_text("import cffi_that_is_not_here")
    monkeypatch.delitem(sys.modules, "wgpu", raising=False)
    with pytest.raises(ImportError, match="cannot be loaded: No module named 'cffi_that_is_not_here'"):
        rw.Gpu()
    monkeypatch.delitem(sys.modules, "wgpu", raising=False)


@pytest.mark.parametrize("error", [TypeError("no argument size"), KeyError("max-buffer-size")])
def test_a_signature_or_a_key_that_has_changed_is_an_import_error(monkeypatch, error):
    monkeypatch.setitem(sys.modules, "wgpu", stand_in())
    says = rf"^wgpu 9\.8\.7 fails when called \({type(error).__name__}"
    with pytest.raises(ImportError, match=says), changes_named():
        raise error


def test_the_table_names_all_that_is_called():
    """Whatever the package's files access by a name of wgpu's public classes is in the table."""
    wgpu = pytest.importorskip("wgpu")
    owners = {owner: {n for n in dir(getattr(wgpu, owner)) if not n.startswith("_")} for owner in CALLED}
    known = {name for names in CALLED.values() for name in names}
    for file in FOLDER.glob("*.py"):
        accessed = {
            node.attr
            for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
            if isinstance(node, ast.Attribute)
        }
        assert accessed & set().union(*owners.values()) <= known, file.name
    assert imported_wgpu() is wgpu


def test_the_extra_allows_what_is_tested():
    project = (Path(__file__).parents[3] / "pyproject.toml").read_text(encoding="utf-8")
    assert f'\ngpu = ["wgpu>={TESTED[0]},<1"]\n' in project
