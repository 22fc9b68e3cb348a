"""Mitsuba's XML: what it stands for, and what is refused before it can do harm."""

import re
import subprocess
import sys

import numpy as np
import pytest

import raywright as rw

EYE = '<sensor type="perspective"><film type="hdrfilm"><integer name="width" value="4"/></film></sensor>'


def load(tmp_path, body, **parameters):
    path = tmp_path / "scene.xml"
    path.write_text(f'<scene version="3.0.0">{EYE}{body}</scene>', encoding="utf-8")
    return rw.from_mitsuba(path, parameters=parameters)


def placed(tmp_path, steps):
    """The matrix of a transform of these steps, as a sphere has it."""
    sphere = f'<shape type="sphere"><transform name="to_world">{steps}</transform></shape>'
    return load(tmp_path, sphere).scene.shapes[0].transform


def test_steps_of_transforms_follow_each_other(tmp_path):
    turned = placed(tmp_path, '<rotate z="2" angle="90"/><translate x="1"/><scale value="2, 3, 4"/>')
    # (1, 0, 0) turns to (0, 1, 0), moves to (1, 1, 0), and is scaled.
    assert np.allclose(turned @ (1, 0, 0, 1), (2, 3, 0, 1), rtol=0, atol=1e-15)
    assert np.allclose(turned @ (0, 0, 1, 1), (2, 0, 4, 1), rtol=0, atol=1e-15)
    assert (placed(tmp_path, '<scale value="2"/>') == np.diag([2, 2, 2, 1])).all()
    numbers = [[1, 2, 0, 4], [0, 1, 0, 5], [0, 0, 1, 6], [0, 0, 0, 1]]
    text = " ".join(str(x) for row in numbers for x in row)
    assert (placed(tmp_path, f'<matrix value="{text}"/>') == numbers).all()
    nine = placed(tmp_path, '<matrix value="1 2 0 0 1 0 0 0 3"/>')
    assert (nine == [[1, 2, 0, 0], [0, 1, 0, 0], [0, 0, 3, 0], [0, 0, 0, 1]]).all()


def test_what_looks_at_something_has_it_along_z_and_x_to_the_left(tmp_path):
    matrix = placed(tmp_path, '<lookat origin="1, 2, 3" target="1 2 8" up="0, 1, 0"/>')
    assert (matrix == [[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]).all()
    free = placed(tmp_path, '<lookat origin="0, 0, 0" target="1, 2, 3"/>')
    assert np.allclose(free[:3, 2], np.array([1, 2, 3]) / 14**0.5, rtol=0, atol=1e-15)
    assert np.allclose(free[:3, :3] @ free[:3, :3].T, np.eye(3), rtol=0, atol=1e-15)
    assert np.linalg.det(free[:3, :3]) > 0


def test_defaults_fill_in_and_are_overridden(tmp_path):
    body = """
        <default name="r" value="0.25"/><default name="rough" value="9"/><default name="kind" value="diff"/>
        <shape type="sphere"><float name="radius" value="$r"/><bsdf type="${kind}use"/></shape>
    """.replace("${kind}", "$kind")
    assert load(tmp_path, body).scene.shapes[0].radius == 0.25
    assert load(tmp_path, body, r=2).scene.shapes[0].radius == 2.0
    with pytest.raises(ValueError, match=r"scene.xml, line 1: \$missing is not given, and has no <default>"):
        load(tmp_path, '<shape type="sphere"><float name="radius" value="$missing"/></shape>')


def test_parameters_are_given_by_name(tmp_path):
    body = '<shape type="sphere"><float name="radius" value="$r"/></shape>'
    load(tmp_path, body, r=1)
    path = tmp_path / "scene.xml"
    assert rw.load(path, r=0.5).scene.shapes[0].radius == 0.5
    assert rw.load(path, width=8, r=0.5).camera.width == 8
    with pytest.raises(ValueError, match=r"^spp is not a parameter of .*scene\.xml; it has r$"):
        rw.load(path, r=0.5, spp=16)
    with pytest.raises(ValueError, match="parameters are for XML files; a dict has none"):
        rw.from_mitsuba({"type": "scene"}, parameters={"r": 1})
    (tmp_path / "a.stl").write_bytes(b"")
    with pytest.raises(TypeError, match=r"spp is not a parameter of .*a\.stl: only Mitsuba scenes have"):
        rw.load(tmp_path / "a.stl", spp=16)


def test_a_folder_more_is_looked_in_last(tmp_path):
    (tmp_path / "more").mkdir()
    ball = '<shape version="3.0.0" type="sphere"><float name="radius" value="2"/></shape>'
    (tmp_path / "more" / "ball.xml").write_text(ball)
    path = tmp_path / "scene.xml"
    path.write_text(f'<scene version="3.0.0">{EYE}<include filename="ball.xml"/></scene>')
    with pytest.raises(FileNotFoundError):
        rw.from_mitsuba(path)
    assert rw.from_mitsuba(path, folder=tmp_path / "more").scene.shapes[0].radius == 2
    (tmp_path / "ball.xml").write_text(ball.replace('"2"', '"3"'))
    assert rw.from_mitsuba(path, folder=tmp_path / "more").scene.shapes[0].radius == 3


def test_files_are_included_and_found_in_folders(tmp_path):
    (tmp_path / "parts").mkdir()
    ball = '<shape version="3.0.0" type="sphere"><ref id="paint"/></shape>'
    (tmp_path / "parts" / "ball.xml").write_text(ball)
    paints = '<scene version="3.0.0"><bsdf type="plastic" id="paint"/><alias id="paint" as="coat"/></scene>'
    (tmp_path / "parts" / "paints.xml").write_text(paints)
    body = """
        <path value="parts"/><include filename="paints.xml"/><include filename="ball.xml"/>
        <shape type="disk"><ref id="coat"/></shape>
    """
    ball, disk = load(tmp_path, body).scene.shapes
    assert ball.material == disk.material
    assert isinstance(ball.material.front, rw.Plastic)
    (tmp_path / "parts" / "ball.xml").write_text(
        '<scene version="3.0.0"><include filename="ball.xml"/></scene>'
    )
    with pytest.raises(ValueError, match=r"ball\.xml, line 1: files include each other more than 15 times"):
        load(tmp_path, body)


def test_files_cannot_be_included_without_end(tmp_path):
    for i in range(14):
        twice = f'<include filename="{i + 1}.xml"/>' * 2
        (tmp_path / f"{i}.xml").write_text(f'<scene version="3.0.0">{twice}</scene>')
    (tmp_path / "14.xml").write_text('<scene version="3.0.0"/>')
    with pytest.raises(ValueError, match="more than 1000 files are included"):
        load(tmp_path, '<include filename="0.xml"/>')


def test_what_has_no_name_does_not_get_in_the_way_of_what_is_included(tmp_path):
    balls = '<shape type="sphere"/><shape type="disk"/><bsdf type="diffuse" id="x"/>'
    for name in ("one", "two"):
        (tmp_path / f"{name}.xml").write_text(f'<scene version="3.0.0">{balls.replace("x", name)}</scene>')
    body = f'{balls}<include filename="one.xml"/><include filename="two.xml"/>'
    assert [type(shape) for shape in load(tmp_path, body).scene.shapes] == [rw.Sphere, rw.Disk] * 3


def test_scenes_of_version_one_have_their_names_renewed(tmp_path):
    path = tmp_path / "old.xml"
    path.write_text(
        """
        <scene version="0.6.0"><sensor type="perspective"><float name="fov" value="20"/></sensor>
        <integrator type="path"><integer name="maxDepth" value="3"/></integrator>
        <texture type="checkerboard" id="theCells"/>
        <shape type="disk"><bsdf type="diffuse"><ref name="diffuseReflectance" id="theCells"/></bsdf></shape>
        <shape type="sphere"><transform name="toWorld">
        <lookAt origin="0, 0, 0" target="0, 0, 1" up="0, 1, 0"/>
        <scale value="2"/></transform>
        <bsdf type="dielectric"><float name="intIOR" value="1.5"/></bsdf></shape></scene>
    """
    )
    shot = rw.load(path)
    assert shot.integrator == rw.Path(max_depth=2)
    disk, ball = shot.scene.shapes
    assert ball.transform[0, 0] == 2
    assert ball.material.ior == 1.5 / 1.000277
    assert disk.material.front.reflectance.range == ((np.float32(0.2),) * 3, (np.float32(0.4),) * 3)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("<scene", "scene.xml is not XML that can be read"),
        ("<mesh version='3'/>", "scene.xml, line 1: <mesh> is not a plugin"),
        ("<scene/>", "line 1: the outermost element must have a version"),
        ("<shape version='3' type='sphere'/>", "must hold a <scene>"),
        ("<scene version='3'>\n<shape/></scene>", "line 2: <shape> must have a type"),
        ("<scene version='3'><blob name='x' value='1'/></scene>", "<blob> is not supported"),
        ("<scene version='3'><float name='x' value='one'/></scene>", "'one' is not a value of <float>"),
        ("<scene version='3'><float name='x'/></scene>", "<float> must have a value"),
        ("<scene version='3'><boolean name='x' value='yes'/></scene>", "'yes' is not a value of <boolean>"),
        ("<scene version='3'><rgb name='x' value='1 2'/></scene>", "'1 2' is not a value of <rgb>"),
        ("<scene version='3'><include/></scene>", "<include> must have 'filename'"),
        (
            "<scene version='3'><bsdf type='diffuse' id='a'/><bsdf type='diffuse' id='a'/></scene>",
            "'a' is given twice",
        ),
        ("<scene version='3'><transform name='x'><spin/></transform></scene>", "<spin> is not a step"),
        (
            "<scene version='3'><transform name='x'><lookat origin='1' target='1'/></transform></scene>",
            "<lookat> must have an origin and a target that differ",
        ),
        (
            f"<scene version='3'>{EYE}<shape type='disk'><ref id='a'/></shape>"
            "<bsdf id='a' type='blendbsdf'><ref id='a'/><ref name='again' id='a'/></bsdf></scene>",
            "plugins nest more than 12 deep",
        ),
        (
            f"<scene version='3'>{EYE}<alias id='a' as='b'/><alias id='b' as='a'/></scene>",
            "references are cyclic",
        ),
        ("<scene version='3'>" + "<shape type='a'>" * 70, "elements nest more than 64 deep"),
    ],
)
def test_what_is_wrong_is_told_with_its_line(tmp_path, text, expected):
    path = tmp_path / "scene.xml"
    path.write_text(text)
    with pytest.raises(ValueError, match=re.escape(expected)) as caught:
        rw.load(path)
    assert "\n" not in str(caught.value)


BOMB = """<?xml version="1.0"?>
<!DOCTYPE lolz [<!ENTITY a0 "lol">{}]>
<scene version="3.0.0"><string name="x" value="&a30;"/></scene>""".format(
    "".join(f'<!ENTITY a{i + 1} "{f"&a{i};" * 10}">' for i in range(30))
)
OUTSIDE = '<!DOCTYPE s [<!ENTITY e SYSTEM "file:///etc/hostname">]><scene version="3.0.0">&e;</scene>'
WINDOW = np.array([0, 0, 31622, 31622], "<i4").tobytes()
PICTURES = {
    "huge.exr": b"v/1\x01\2\0\0\0compression\0compression\0\1\0\0\0\3dataWindow\0box2i\0\x10\0\0\0"
    + WINDOW
    + b"\0",
    "huge.hdr": b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 31623 +X 31623\n",
    "huge.png": b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"
    + np.array([31623, 31623], ">u4").tobytes()
    + b"\x08\2\0\0\0\xb3\xc4\xd5\xe6",
}


def run_limited(path, tmp_path):
    """Load a file in a process of 1 GB of address space beyond what it has at the start; its last word."""
    code = (
        "import resource, sys, time, raywright as rw\n"
        "import numpy, PIL.Image\n"
        "pages = int(open('/proc/self/statm').read().split()[0])\n"
        "limit = pages * resource.getpagesize() + 2**30\n"
        "resource.setrlimit(resource.RLIMIT_AS, (limit, limit))\n"
        "began = time.process_time()\n"
        "try: rw.load(sys.argv[1])\n"
        "except ValueError as error: print(time.process_time() - began, error)\n"
    )
    done = subprocess.run([sys.executable, "-c", code, path], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    seconds, _, told = done.stdout.strip().partition(" ")
    assert float(seconds) < 1
    assert "\n" not in told
    return told


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="asks Linux for its memory")
@pytest.mark.parametrize("text", [BOMB, OUTSIDE])
def test_a_doctype_is_refused_before_any_entity(tmp_path, text):
    path = tmp_path / "scene.xml"
    path.write_text(text)
    assert re.search(r"scene.xml, line \d: a DOCTYPE is not allowed", run_limited(path, tmp_path))


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="asks Linux for its memory")
@pytest.mark.parametrize("name", PICTURES)
def test_pictures_of_a_thousand_million_pixels_are_refused_by_their_header(tmp_path, name):
    (tmp_path / name).write_bytes(PICTURES[name])
    path = tmp_path / "scene.xml"
    around = f'<emitter type="envmap"><string name="filename" value="{name}"/></emitter>'
    texture = (
        f'<shape type="sphere"><bsdf type="diffuse"><texture type="bitmap" name="reflectance">'
        f'<string name="filename" value="{name}"/></texture></bsdf></shape>'
    )
    # Both read all kinds alike, and each needs its own process.
    for body in (around, texture) if name == next(iter(PICTURES)) else (around,):
        path.write_text(f'<scene version="3.0.0">{EYE}{body}</scene>')
        assert f"{name} is not a picture that can be read" in run_limited(path, tmp_path)
