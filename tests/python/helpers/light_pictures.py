"""Scenes for paths that start at lights, and how their pictures are compared with those of other paths."""

import math

import numpy as np
import pytest

import raywright as rw

SIDE = 24


def square(size, height, *, up=True, **kwargs):
    """A horizontal square about the axis that faces up or down."""
    corners = [(-size, -size, height), (size, -size, height), (size, size, height), (-size, size, height)]
    faces = [(0, 1, 2), (0, 2, 3)] if up else [(0, 2, 1), (0, 3, 2)]
    return rw.Mesh(corners, faces, **kwargs)


def lamp(height=2.0, size=0.5, radiance=20.0):
    """A black square that shines down."""
    return square(size, height, up=False, material=rw.Diffuse(0), emission=radiance)


def camera(at=(3, -2, 2.5), target=(0, 0, 0.3), fov=40, side=SIDE):
    """A camera that looks down on the origin."""
    return rw.Camera(at, target, up=(0, 0, 1), fov=fov, width=side, height=side)


def ball(divisions, material, center=(0, 0, 0.6), radius=0.6):
    """A ball of few triangles with the normals of a sphere."""
    trimesh = pytest.importorskip("trimesh")
    sphere = trimesh.creation.icosphere(divisions, radius)
    normals = sphere.vertices / np.linalg.norm(sphere.vertices, axis=1, keepdims=True)
    return rw.Mesh(sphere.vertices + center, sphere.faces, normals=normals, material=material)


def behind_glass():
    """A lamp in a block of glass, seen through a pane of glass."""
    trimesh = pytest.importorskip("trimesh")
    glass = rw.Dielectric(1.5)

    def block(extents, center):
        box = trimesh.creation.box(extents)
        return rw.Mesh(box.vertices + center, box.faces, material=glass)

    floor = square(1.5, 0.0, material=rw.Diffuse((0.7, 0.5, 0.3)))
    lamp = square(0.25, 1.2, up=False, material=rw.Diffuse(0), emission=8)
    return [floor, block((1.0, 1.0, 0.6), (0, 0, 1.15)), block((6.0, 0.1, 6.0), (0, -2.0, 0))], lamp


MATERIALS = {
    "diffuse": rw.Diffuse((0.8, 0.5, 0.2)),
    "Oren-Nayar": rw.materials.OrenNayar(0.7, 0.4),
    "rough gold": rw.Conductor("Au", roughness=0.5),
    "plastic": rw.Plastic((0.2, 0.4, 0.7), roughness=0.4),
    "Phong": rw.materials.Phong(0.4, 0.4, 20),
    "rough glass": rw.Dielectric(1.5, roughness=0.6),
    "metallic": rw.MetallicRough((0.7, 0.3, 0.2), 0.5, 0.5),
}


def blocks(values):
    """Means over blocks of 8 x 8 pixels."""
    side = values.shape[0]
    return values.astype(float).reshape(side // 8, 8, side // 8, 8, 3).mean((1, 3))


def assert_same(scene, camera, ours, theirs):
    """Blocks of 8 x 8 pixels, of two integrators with samples each, agree within five of the joint standard
    errors, which chance exceeds once in two million. In the middle block those are below a tenth."""
    ours, theirs = (rw.render(scene, camera, *way, progress=False) for way in (ours, theirs))
    off = np.abs(blocks(ours.rgb) - blocks(theirs.rgb))
    variance = blocks(ours.standard_error.astype(float) ** 2) + blocks(
        theirs.standard_error.astype(float) ** 2
    )
    error = np.sqrt(variance / 64)
    ratio = off / (error + 1e-6 * blocks(theirs.rgb) + 1e-12)
    assert ratio.max() < 5, ratio.round(1)
    assert np.median(error / (blocks(theirs.rgb) + 1e-12)) < 0.1
    return ours, theirs


def small_blocks(values, size=4):
    side = values.shape[0] // size
    return values.astype(float).reshape(side, size, side, size, 3).mean((1, 3))


def assert_agree(scene, camera, integrator, truth, *, seeds=5, samples=8, blur=0.04):
    """Blocks of pixels agree within five joint standard errors, and twice the bias that is told, or `blur`.

    Those of the maps are told by pictures of other seeds. Five standard errors of six pictures are exceeded
    in one of 250 cases; with what is left for the bias, far more rarely.
    """
    ours = [rw.render(scene, camera, integrator, samples, seed=seed, progress=False) for seed in range(seeds)]
    each = np.array([small_blocks(image.rgb) for image in ours])
    mean, error = each.mean(0), each.std(0, ddof=1) / math.sqrt(seeds)
    expected, other = (
        small_blocks(truth.rgb),
        np.sqrt(small_blocks(truth.standard_error.astype(float) ** 2) / 16),
    )
    bias = np.abs(np.mean([small_blocks(image.bias) for image in ours], 0))
    allowed = 5 * np.hypot(error, other) + 2 * bias + blur * expected + 1e-6
    off = np.abs(mean - expected) / allowed
    assert off.max() < 1, off.round(2)
    # The mean of the picture has a smaller error than its blocks.
    whole = 5 * math.hypot(error.mean(), other.mean()) + 2 * bias.mean()
    assert abs(mean.mean() - expected.mean()) < whole + 0.02 * expected.mean()
