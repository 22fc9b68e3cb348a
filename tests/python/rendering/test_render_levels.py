"""The same picture, bit for bit, at every level of the processor's vector instructions."""

import os
import subprocess
import sys

import pytest

import raywright as rw

# Scenes with every part of shading that is compiled per SIMD level: diffuse rooms with lamps of triangles,
# smooth normals and masks, two-sided sheets, metal, glass and plastic, round lamps, skies, and each kind of
# sampler.
PICTURES = """
import hashlib
import raywright as rw

def tell(name, scene, camera, integrator=rw.Path(), **how):
    image = rw.render(scene, camera, integrator, samples=8, progress=False, **how)
    print(name, hashlib.sha256(image.rgb.tobytes()).hexdigest(), flush=True)

size = {"width": 24, "height": 20}
cornell = rw.scenes.cornell_box(**size)
kinds = rw.rendering
batched = [kind(4) for kind in (kinds.Stratified, kinds.Halton, kinds.Sobol, kinds.Lattice)]
for sampler in (kinds.Independent(), *batched):
    tell(type(sampler).__name__, *cornell, sampler=sampler)
tell("reuse", *cornell, rw.Path(reuse=4))
tell("plates", *rw.scenes.veach_plates(**size))
tell("spheres", *rw.scenes.glass_spheres(**size))
tell("caustics", *rw.scenes.glass_spheres(**size), rw.Path(guiding="photons"))
tell("whitted", *rw.scenes.glass_spheres(**size), rw.Whitted())
tell("distributed", *rw.scenes.veach_plates(**size), rw.integrators.Distributed(splits=3))

knot = rw.scenes.torus_knot(along=60, around=9)
sheet = rw.TwoSided(rw.Diffuse((0.2, 0.5, 0.7)), rw.Diffuse(0.1))
floor = rw.Mesh([(-4, -2, -4), (-4, -2, 4), (4, -2, 4), (4, -2, -4)], [(0, 1, 2), (0, 2, 3)], material=sheet)
holes = rw.Mask(rw.Diffuse(0.6), 0.4)
veil = rw.Mesh([(-2, -2, 2), (2, -2, 2), (0, 2, 2)], [(0, 1, 2)], material=holes)
lamp = rw.Mesh([(-1, 3, -1), (1, 3, -1), (0, 3, 1)], [(0, 1, 2)], emission=5)
camera = rw.Camera((0, 1, 6), (0, 0, 0), **size)
tell("sky", rw.Scene([knot, floor], environment=0.7), camera)
ball, point = rw.Sphere((1, 0, 1), 0.5), rw.PointLight((0, 3, 3), 2)
tell("smooth", rw.Scene([knot, floor, lamp, ball], [point]), camera)
tell("masks", rw.Scene([knot, floor, lamp, veil]), camera)
blue, gold = (0.2, 0.4, 0.8), rw.Conductor("Au")
glossy = rw.Plastic(blue), rw.Plastic(blue, roughness=0.5), rw.MetallicRough(blue, 0.5, 0.3)
kinds = *glossy, gold, rw.Mirror(0.9), rw.ThinDielectric(1.5), rw.Dielectric(1.5)
balls = [rw.Sphere((x - 3, -1, 0), 0.45, material=kind) for x, kind in enumerate(kinds)]
tell("kinds", rw.Scene([floor, lamp, *balls]), camera)
tell("guided", rw.Scene([floor, lamp, *balls]), camera, rw.Path(guiding="photons"))

mixed = rw.Mix(rw.Mix(rw.Diffuse(blue), gold, 0.3), rw.Dielectric(1.5, roughness=0.4), 0.5)
principled = rw.Principled(blue, metallic=0.2, transmission=0.3, clearcoat=0.8, sheen=0.5)
others = (
    rw.Dielectric(1.5, roughness=0.5),
    rw.Dielectric(1.5, roughness=0.3, distribution="beckmann"),
    rw.Conductor("Au", roughness=0.4, distribution="beckmann", multiple_scattering=False),
    rw.Plastic(blue, roughness=0.4, multiple_scattering=False),
    principled,
    rw.materials.PrincipledThin(blue, transmission=0.4),
    rw.materials.OrenNayar(blue, 0.6),
    rw.materials.Phong(blue, 0.2, 30),
    rw.materials.BlinnPhong(blue, 0.2, 30),
    mixed,
    rw.materials.Tinted(rw.Dielectric(1.5), transmittance=blue),
    rw.materials.ThinFilm(300, ior=1.5, base=rw.Dielectric(1.33)),
    rw.materials.SoapFilm(400),
)
balls = [rw.Sphere((x % 7 - 3, x // 7 - 1, 0), 0.45, material=kind) for x, kind in enumerate(others)]
tell("others", rw.Scene([floor, lamp, *balls]), camera)
tell("others split", rw.Scene([floor, lamp, *balls]), camera, rw.integrators.Distributed(splits=3))
"""


@pytest.mark.skipif(rw.simd() in ("scalar", "neon", "sse2"), reason="there is one level only")
def test_levels_change_no_bit():
    def told(level):
        how = {**os.environ, "RAYWRIGHT_SIMD": level}
        run = subprocess.run(
            [sys.executable, "-c", PICTURES], capture_output=True, text=True, env=how, timeout=300
        )
        # A processor has some of the levels only.
        assert run.returncode == 0 or "expected one of" in run.stderr, run.stderr
        return run.stdout.splitlines() if run.returncode == 0 else None

    levels = [lines for level in ("neon", "sse2", "avx2", "avx512") if (lines := told(level)) is not None]
    reference = levels[0]
    assert len({line.split()[1] for line in reference}) == len(reference) == 18
    assert all(other == reference for other in levels)
