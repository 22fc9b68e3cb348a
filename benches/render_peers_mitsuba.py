"""Scenes of raywright as Mitsuba 3 has them, and the pictures that it makes of them."""

import tempfile
import time
from pathlib import Path

import numpy as np

import raywright as rw

# Mitsuba's names of samplers. Its ldsampler is left out: it is biased by 0.4 %.
SAMPLERS = ("independent", "stratified", "multijitter", "orthogonal")
VARIANT = "llvm_ad_rgb"


class Mitsuba:
    """Mitsuba on all cores, with one of its samplers."""

    package = "mitsuba"

    def __init__(self, scene, camera, depth, sampler):
        import drjit
        import mitsuba

        if mitsuba.variant() != VARIANT:
            mitsuba.set_variant(VARIANT)
        self.dr, self.mi = drjit, mitsuba
        self.name = f"mitsuba {sampler}"
        with tempfile.TemporaryDirectory() as folder:
            self.scene = mitsuba.load_dict(_described(mitsuba, scene, camera, sampler, Path(folder)))
        # Mitsuba's depth counts the rays of a path, ours its reflections.
        self.integrator = mitsuba.load_dict({"type": "path", "max_depth": -1 if depth is None else depth + 1})

    def render(self, samples, seed):
        """Return a picture and the seconds that it took."""
        start = time.perf_counter()
        image = self.mi.render(self.scene, integrator=self.integrator, seed=seed, spp=samples)
        picture = np.array(image)
        return picture.astype(np.float64), time.perf_counter() - start


def _described(mi, scene, camera, sampler, folder):
    """Return the dict of a scene and a camera."""
    look = mi.ScalarTransform4f().look_at(origin=camera.position, target=camera.target, up=camera.up)
    all_of_it = {
        "type": "scene",
        "sensor": {
            "type": "perspective",
            "fov": camera.fov,
            "fov_axis": "y",
            "to_world": look,
            "near_clip": 1e-3 * float(np.linalg.norm(np.subtract(camera.target, camera.position))),
            "far_clip": 1e7,
            "sampler": {"type": sampler},
            "film": {
                "type": "hdrfilm",
                "width": camera.width,
                "height": camera.height,
                "pixel_format": "rgb",
                "component_format": "float32",
                "rfilter": {"type": "box"},
            },
        },
    }
    for number, shape in enumerate(scene.shapes):
        described = _shape(mi, shape, folder / f"{number}.ply")
        described["bsdf"] = _material(shape.material)
        if shape.emission is not None:
            described["emitter"] = {"type": "area", "radiance": _rgb(shape.emission)}
        all_of_it[f"shape{number}"] = described
    for number, light in enumerate(scene.lights):
        all_of_it[f"light{number}"] = {
            "type": "point",
            "position": list(light.position),
            "intensity": _rgb(light.intensity),
        }
    if scene.environment is not None:
        all_of_it["environment"] = {"type": "constant", "radiance": _rgb(scene.environment.radiance)}
    return all_of_it


def by_constants(scene, camera):
    """Return a scene whose metals are as Mitsuba has them.

    Their index is that at 630, 532 and 465 nm, for Mitsuba has no spectra in RGB, and what facets throw on
    facets is lost.
    """

    def told(material):
        if not isinstance(material, rw.Conductor) or material.metal is None:
            return material
        wavelengths, *index = rw.materials.metal_index(material.metal)
        eta, k = (np.interp((630, 532, 465), wavelengths, values) for values in index)
        return rw.Conductor(eta=eta, k=k, alpha=material.alpha, multiple_scattering=False)

    def of(shape, material):
        if material is shape.material:
            return shape
        if isinstance(shape, rw.Sphere):
            return rw.Sphere(shape.center, shape.radius, material=material, emission=shape.emission)
        return rw.Mesh(shape.vertices, shape.faces, material=material, emission=shape.emission)

    shapes = [of(shape, told(shape.material)) for shape in scene.shapes]
    return rw.Scene(shapes, scene.lights, scene.environment), camera


def _shape(mi, shape, path):
    kind = type(shape).__name__
    if kind == "Sphere" and shape.transform is None:
        return {"type": "sphere", "center": list(shape.center), "radius": shape.radius}
    if kind == "Box" and shape.transform is None:
        low, high = np.array(shape.min), np.array(shape.max)
        place = mi.ScalarTransform4f().translate((low + high) / 2).scale((high - low) / 2)
        return {"type": "cube", "to_world": place}
    if kind != "Mesh":
        raise TypeError(f"{kind} is not told to Mitsuba")
    mesh = mi.Mesh("mesh", len(shape.vertices), len(shape.faces))
    parts = mi.traverse(mesh)
    parts["vertex_positions"] = mi.Float(shape.vertices.astype(np.float32).reshape(-1))
    parts["faces"] = mi.UInt(shape.faces.astype(np.uint32).reshape(-1))
    parts.update()
    mesh.write_ply(str(path))
    return {"type": "ply", "filename": str(path), "face_normals": True}


def _material(material):
    kind = type(material).__name__
    if kind == "Diffuse":
        return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": _rgb(material.reflectance)}}
    if kind == "Mirror":
        return {"type": "twosided", "bsdf": {"type": "conductor", "material": "none"}}
    if kind == "Dielectric" and material.alpha is None:
        return {"type": "dielectric", "int_ior": material.ior, "ext_ior": 1.0}
    if kind == "Conductor":
        described = {"type": "conductor", "eta": _rgb(material.eta), "k": _rgb(material.k)}
        if material.alpha is not None:
            described |= {"type": "roughconductor", "distribution": "ggx", "alpha": material.alpha}
        return {"type": "twosided", "bsdf": described}
    raise TypeError(f"{material} is not told to Mitsuba")


def _rgb(color):
    return {"type": "rgb", "value": [float(x) for x in color]}
