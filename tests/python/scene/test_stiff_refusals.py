"""What cannot be is refused when it is described, with one line that names it and says what came."""

import math

import numpy as np
import pytest

import raywright as rw

NOWHERE = (0, 0, 0)
NAN, INF = math.nan, math.inf

# All emitters, as functions of their strength.
SHINING = {
    "point": lambda s: rw.PointLight(NOWHERE, s),
    "spot": lambda s: rw.SpotLight((0, 0, 1), NOWHERE, s),
    "direction": lambda s: rw.DirectionalLight((0, 0, -1), s),
    "projector": lambda s: rw.ProjectorLight([[1.0]], (0, 0, 1), NOWHERE, intensity=s),
    "constant": lambda s: rw.ConstantEnvironment(s),
    "scene": lambda s: rw.Scene([], environment=s),
    "map": lambda s: rw.EnvironmentMap([[s]]),
    "scaled map": lambda s: rw.EnvironmentMap([[1.0]], scale=s),
    "emission": lambda s: rw.Emission(s),
    "mesh": lambda s: rw.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)], emission=s),
    "sphere": lambda s: rw.Sphere(NOWHERE, 1, emission=s),
    "ambient": lambda s: rw.Whitted(ambient=s),
    "cast": lambda s: rw.RayCast(ambient=s),
}


def refused(told, make, *arguments, **named):
    with pytest.raises(ValueError, match=told) as caught:
        make(*arguments, **named)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 200


@pytest.mark.parametrize("kind", SHINING)
def test_radiance_is_a_number_and_not_negative(kind):
    make = SHINING[kind]
    for strength in (NAN, INF, -INF):
        refused("finite", make, strength)
    for strength in (-1, -1e-30):
        refused(f"at least 0, got .*{strength}", make, strength)
    if kind not in ("map", "scaled map", "projector"):
        refused("finite", make, (1, NAN, 1))
        refused("at least 0", make, (1, 1, -1))
    make(0)
    make(1e30)


# All shapes with a radius, as functions of it.
ROUND = {
    "sphere": lambda r: rw.Sphere(NOWHERE, r),
    "disk": lambda r: rw.Disk(NOWHERE, (0, 0, 1), r),
    "cylinder": lambda r: rw.Cylinder(NOWHERE, (0, 0, 1), r),
    "ellipsoid": lambda r: rw.shapes.Ellipsoid(NOWHERE, (r, r, r)),
    "torus": lambda r: rw.Torus(NOWHERE, (0, 0, 1), r, 0.1),
    "thin torus": lambda r: rw.Torus(NOWHERE, (0, 0, 1), 1.0, r),
    "occlusion": lambda r: rw.AmbientOcclusion(radius=r),
}


@pytest.mark.parametrize("kind", ROUND)
def test_a_radius_is_greater_than_0(kind):
    for radius in (0.0, -0.0, -1.0, -1e-300):
        refused("must (each )?be greater than 0, got", ROUND[kind], radius)
    refused("must be finite, got", ROUND[kind], NAN)


def test_a_cone_has_a_base_or_a_tip():
    refused("base_radius and tip_radius must not both be 0", rw.Cone, base_radius=0.0)
    refused("base_radius must be at least 0, got -1", rw.Cone, base_radius=-1.0)
    refused("tip_radius must be at least 0, got -1", rw.Cone, tip_radius=-1.0)
    refused("base_radius must be finite, got nan", rw.Cone, base_radius=NAN)


@pytest.mark.parametrize("kind", [rw.Camera, rw.ThinLens, rw.Orthographic, rw.Fisheye, rw.Panorama])
def test_a_camera_looks_somewhere(kind):
    refused("position and target must differ, got", kind, (1, 2, 3), (1, 2, 3))
    for up in ((0, 1, 0), (0, -2, 0), (0, 0, 0)):
        refused("up must", kind, (0, 0, 0), (0, 3, 0), up=up)
    refused("position must be finite", kind, (0, 0, NAN), (0, 3, 0))
    refused("target must be finite", kind, (0, 0, 0), (0, INF, 0))


def test_a_light_with_a_direction_shines_somewhere():
    refused("target must differ from position", rw.SpotLight, (1, 2, 3), (1, 2, 3), 1)
    refused("target must differ from position", rw.ProjectorLight, [[1.0]], (1, 2, 3), (1, 2, 3))
    refused("up must", rw.ProjectorLight, [[1.0]], (0, 0, 0), (0, 3, 0), up=(0, 1, 0))
    refused("direction must not be zero", rw.DirectionalLight, (0, 0, 0), 1)


@pytest.mark.parametrize("ior", [0.0, -0.0, -1.5, NAN, INF])
def test_an_index_of_refraction_is_greater_than_0(ior):
    told = "must be greater than 0, got" if math.isfinite(ior) else "must be finite, got"
    refused(f"ior {told}", rw.Dielectric, ior)
    refused(f"ior {told}", rw.ThinDielectric, ior)
    refused("ior must be", rw.Plastic, 0.5, ior)
    refused(f"eta {told}", rw.Conductor, eta=ior, k=3)


ALBEDOS = {
    "diffuse": rw.Diffuse,
    "rough": rw.materials.OrenNayar,
    "mirror": rw.Mirror,
    "plastic": rw.Plastic,
    "phong": lambda albedo: rw.materials.Phong(albedo, 0.0),
    "highlight": lambda albedo: rw.materials.BlinnPhong(0.0, albedo),
    "glTF": rw.MetallicRough,
    "texture": lambda albedo: rw.Diffuse(rw.Checker(0.5, albedo)),
    "picture": lambda albedo: rw.Diffuse(rw.ImageTexture(np.full((2, 2), albedo))),
    "mixed texture": lambda albedo: rw.Diffuse(rw.textures.MixTexture(0.1, albedo, 0.5)),
}


@pytest.mark.parametrize("kind", ALBEDOS)
def test_an_albedo_is_between_0_and_1(kind):
    for albedo in (1.001, 1 + 1e-6, -0.01, 1e30):
        refused("between 0 and 1", ALBEDOS[kind], albedo)
    for albedo in (NAN, INF):
        refused("finite", ALBEDOS[kind], albedo)
    ALBEDOS[kind](1.0)
    ALBEDOS[kind](0.0)
