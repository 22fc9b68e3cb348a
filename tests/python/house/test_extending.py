"""docs/extending.md: the files that a new kind of thing touches, and the tables that recognize it."""

import re
from importlib import import_module
from pathlib import Path

import pytest

import raywright as rw

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs" / "extending.md").read_text(encoding="utf-8")
ROWS = {
    row[0]: row[1:] for row in re.findall(r"^\| (\w+) \|" + r" `(\S+)` \|" * 4 + r" (\d) \|$", PAGE, re.M)
}
MOST = {"material": 5, "shape": 4, "light": 4, "medium": 4, "integrator": 4, "texture": 4, "camera": 4}
# Modules, names and readers of all tables of the core: `("shapes.sphere", "Sphere",`.
READ = re.compile(r'\(\s*"(\w+\.\w+)",\s*"(\w+)",')
READERS = sorted((ROOT / "rust" / "python" / "src").rglob("*.rs"))


def test_all_kinds_have_a_row_and_a_section():
    assert ROWS.keys() == MOST.keys()
    sections = set(re.findall(r"^## An? (\w+)$", PAGE, re.M))
    assert sections == {*MOST, "sampler", "accelerator"}


@pytest.mark.parametrize("kind", MOST)
def test_a_new_kind_touches_few_files(kind):
    code, name, reader, described, count = ROWS[kind]
    files = [code, name, reader, described]
    assert len(set(files)) == int(count) <= MOST[kind]
    # The example adds the first and the last; the others are there.
    assert [(ROOT / file).exists() for file in files] == [False, True, True, False]
    assert (ROOT / described).parent.is_dir()
    assert Path(code).parent == Path(name).parent
    assert "Kinds::new(" in (ROOT / reader).read_text(encoding="utf-8")
    # Neither side of the project lists the classes of a kind anywhere else: its base class is enough.
    package = import_module(".".join(Path(described).parts[1:3]))
    assert isinstance(
        getattr(package, {"camera": "AnyCamera", "integrator": "CoreIntegrator"}.get(kind, kind.title())),
        type,
    )


def test_no_class_is_recognized_by_its_name_alone():
    named = re.compile(r"get_type\(\)\s*\.(?:qual)?name\(\)")
    found = {file.name for file in READERS if named.search(file.read_text(encoding="utf-8"))}
    # It tells the names of classes in its errors.
    assert found == {"python_integrator.rs"}


def test_every_row_of_the_tables_is_a_class_of_that_module():
    rows = [row for file in READERS for row in READ.findall(file.read_text(encoding="utf-8"))]
    assert len(rows) > 70
    for module, name in rows:
        kind = getattr(import_module(f"raywright.{module}"), name)
        assert isinstance(kind, type)
        assert kind.__module__ == f"raywright.{module}", name


def test_a_light_needs_its_base_class_only():
    class Lamp(rw.PointLight):
        pass

    class Glow(type("Base", (), {})):
        pass

    assert rw.Scene([], lights=[Lamp((0, 0, 0), 1)]).lights[0].position == (0, 0, 0)
    with pytest.raises(TypeError, match="lights must be raywright lights, got Glow"):
        rw.Scene([], lights=[Glow()])
