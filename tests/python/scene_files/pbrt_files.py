"""Scenes of pbrt, written for tests."""

import raywright as rw

HEAD = """
LookAt 0 0 5  0 0 0  0 1 0
Camera "perspective" "float fov" 50
Film "rgb" "integer xresolution" [ 40 ] "integer yresolution" 30
Sampler "independent" "integer pixelsamples" 8
Integrator "volpath" "integer maxdepth" 3
"""


def load(folder, world, head=HEAD):
    """Return the shot of a scene: of its options, and of what stands after WorldBegin."""
    path = folder / "scene.pbrt"
    path.write_text(f"{head}\nWorldBegin\n{world}", encoding="utf-8")
    return rw.load(path)


def material(folder, text):
    """Return the material of a sphere after some directives."""
    (ball,) = load(folder, f'{text}\nShape "sphere"').scene.shapes
    return ball.material
