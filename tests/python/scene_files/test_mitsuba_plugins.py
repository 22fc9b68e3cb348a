"""The table of Mitsuba's plugins is that of what the reader knows, and what it says is refused is so."""

import importlib.util
import re
from pathlib import Path

import pytest

import raywright as rw

DOCS = Path(__file__).parents[3] / "docs"
spec = importlib.util.spec_from_file_location("mitsuba_plugins", DOCS / "mitsuba_plugins.py")
plugins = importlib.util.module_from_spec(spec)
spec.loader.exec_module(plugins)

EYE = {"type": "perspective", "film": {"type": "hdrfilm", "width": 8, "height": 4}}
KNOWN = {name for names in plugins.READ.values() for name in names}
REFUSED = [name for names in plugins.REFUSED.values() for name in names]


def test_the_table_is_current():
    page = (DOCS / "from_mitsuba.md").read_text(encoding="utf-8")
    assert plugins.written(page) == page
    assert set(plugins.NEARLY) <= KNOWN
    assert not KNOWN & set(REFUSED)


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_refused_is_refused_by_name(name):
    of_a_color = name in plugins.REFUSED["textures and colors"]
    inner = {"type": "diffuse", "reflectance": {"type": name}} if of_a_color else {"type": name}
    scene = {"type": "scene", "eye": EYE, "ball": {"type": "sphere", "inner": inner}}
    if name in (*plugins.REFUSED["sensors"], *plugins.REFUSED["integrators"]):
        scene = {"type": "scene", "eye": EYE, "ball": {"type": "sphere"}, "other": inner}
    with pytest.raises(ValueError, match=re.escape(name)):
        rw.from_mitsuba(scene)
