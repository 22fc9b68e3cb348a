"""The names at the top are those that most scripts use; the others are where their kind is."""

from types import ModuleType

import pytest

import raywright as rw


def test_the_top_holds_what_most_scripts_use():
    names = [name for name in rw.__all__ if not isinstance(getattr(rw, name), ModuleType)]
    assert len(names) <= 75
    assert {"Scene", "Mesh", "Camera", "render", "load", "view", "Path", "Diffuse", "Sphere"} <= set(names)


def test_subpackages_export_what_is_public_of_them():
    for room in (getattr(rw, name) for name in rw.__all__ if isinstance(getattr(rw, name), ModuleType)):
        assert len(room.__all__) == len(set(room.__all__))
        assert all(hasattr(room, name) for name in room.__all__), room.__name__


@pytest.mark.parametrize(
    ("name", "home"),
    [
        ("Sellmeier", "materials"),
        ("Hits", "query"),
        ("Sobol", "rendering"),
        ("SkyView", None),
        ("ViewFactors", "exchange"),
    ],
)
def test_a_name_that_is_elsewhere_is_found(name, home):
    with pytest.raises(AttributeError, match=f"no attribute '{name}'") as raised:
        getattr(rw, name)
    assert str(raised.value).endswith(f"; it is raywright.{home}.{name}") == (home is not None)
