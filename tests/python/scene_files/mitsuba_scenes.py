"""Small scenes in Mitsuba's format, one or more for each plugin that is read."""

import numpy as np
from mitsuba_parts import (
    EYE,
    FLOOR,
    GOLD,
    LAMP,
    ROUGH,
    SIZE,
    SKY,
    TILED,
    ball,
    checks,
    looking,
    matrix,
    moved,
    picture,
    plate,
    rgb,
    scene,
)
from mitsuba_scenes_extended import extended
from mitsuba_scenes_media import filled
from mitsuba_spectral import spectral


def scenes():
    """Return the scenes, as dicts, by name. The files that they name are `mitsuba_files.write_files`'s."""
    matt = {"type": "diffuse", "reflectance": rgb(0.7, 0.3, 0.1)}
    sheet = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": rgb(0.2, 0.5, 0.7)}}
    around = {"type": "envmap", "filename": "around.hdr", "scale": 1.5, "to_world": moved(0, 0, 0, 1.0, 30.0)}
    upright = {**around, "to_world": matrix((0, 0, 0), (1, 0, 0), (0, 0, 1), (0, -1, 0))}
    return {
        "sphere, rectangle, diffuse, area": scene(a=FLOOR, b=ball(matt), lamp=LAMP),
        "disk, cylinder, twosided": scene(
            a={"type": "disk", "to_world": moved(0, 0, 0, 3.0), "bsdf": {"type": "diffuse"}},
            b={"type": "cylinder", "p0": [-1, 0, 0.5], "p1": [0.8, 0.5, 1.2], "radius": 0.6, "bsdf": sheet},
            lamp={**LAMP, "type": "disk"},
        ),
        "cube, checkerboard, point": scene(
            a=TILED,
            b={
                "type": "cube",
                "to_world": moved(0, 0, 0.6, 0.6, 25.0),
                "bsdf": {"type": "diffuse", "reflectance": checks(1.0, 2.0)},
            },
            c={
                "type": "disk",
                "to_world": looking((-1.3, -0.8, 0.7), (0, -5, 2)),
                "bsdf": {"type": "diffuse", "reflectance": checks(1.0, 1.0)},
            },
            lamp={"type": "point", "position": [2, -3, 4], "intensity": rgb(20.0, 18.0, 15.0)},
        ),
        "obj, bitmap, directional": scene(
            a=FLOOR,
            b={
                "type": "obj",
                "filename": "bowl.obj",
                "to_world": moved(0, 0, 0.2),
                "bsdf": {
                    "type": "twosided",
                    "bsdf": {"type": "diffuse", "reflectance": picture("colors.png")},
                },
            },
            lamp={"type": "directional", "direction": [0.3, 0.6, -1.0], "irradiance": rgb(2.0, 2.2, 2.5)},
        ),
        "bitmap, turned and mirrored": scene(
            2,
            a={
                **FLOOR,
                "to_world": plate(1.5, 1.5, 1.0),
                "bsdf": {
                    "type": "diffuse",
                    "reflectance": picture(
                        "colors.png",
                        wrap_mode="mirror",
                        filter_type="nearest",
                        to_uv=matrix((-0.4, 0.6, 0), (1.75, 0.96, 0), (-1.44, 2.63, 0), (0, 0, 1)),
                    ),
                },
            },
            sky=SKY,
        ),
        "cylinder, sphere, checkerboard": scene(
            2,
            a={
                "type": "cylinder",
                "p0": [-1, 0, 0.5],
                "p1": [1, 0.3, 1.5],
                "radius": 0.7,
                "bsdf": {"type": "diffuse", "reflectance": checks(3.0, 2.0)},
            },
            b={
                "type": "sphere",
                "radius": 0.5,
                "to_world": moved(1, -1, 0.5, 1.0, 40.0),
                "bsdf": {"type": "diffuse", "reflectance": checks(4.0, 3.0)},
            },
            sky=SKY,
        ),
        "ply, face_normals, spot": scene(
            a=FLOOR,
            b={
                "type": "ply",
                "filename": "gem.ply",
                "face_normals": True,
                "to_world": moved(0, 0, 1),
                "bsdf": matt,
            },
            lamp={
                "type": "spot",
                "to_world": looking((1, -3, 5), (0, 0, 0.5)),
                "intensity": rgb(60.0),
                "cutoff_angle": 18.0,
                "beam_width": 6.0,
            },
        ),
        "shapegroup, instance": scene(
            a=FLOOR,
            group={
                "type": "shapegroup",
                "one": {"type": "sphere", "radius": 0.4, "bsdf": matt},
                "two": {
                    "type": "ply",
                    "filename": "gem.ply",
                    "face_normals": True,
                    "to_world": moved(0, 0, 0.6, 0.4),
                    "bsdf": sheet,
                },
            },
            b={
                "type": "instance",
                "to_world": moved(-1, 0, 0.5, 1.0, 20.0),
                "group": {"type": "ref", "id": "group"},
            },
            c={
                "type": "instance",
                "to_world": moved(1, -0.5, 0.4, (0.7, 0.7, 1.2)),
                "group": {"type": "ref", "id": "group"},
            },
            lamp=LAMP,
            sky=SKY,
        ),
        "dielectric": scene(12, a=TILED, b=ball({"type": "dielectric", "int_ior": "diamond"}), sky=SKY),
        "roughdielectric": scene(
            12,
            a=TILED,
            sky=SKY,
            b={
                "type": "rectangle",
                "to_world": plate(1.2, 1.2, 1.0),
                "bsdf": {"type": "roughdielectric", "int_ior": 1.5, "ext_ior": 1.0, **ROUGH},
            },
        ),
        "thindielectric": scene(
            6,
            a=TILED,
            b={
                "type": "rectangle",
                "to_world": looking((0, -1, 1), (1, -5, 2)),
                "bsdf": {"type": "thindielectric", "int_ior": "bk7"},
            },
            sky=SKY,
        ),
        "conductor, envmap": scene(a=TILED, b=ball({"type": "conductor", **GOLD}), sky=upright),
        "mirror, envmap turned": scene(
            a={**FLOOR, "bsdf": {"type": "conductor", "specular_reflectance": rgb(0.9, 0.5, 0.2)}},
            sky=around,
            b=ball({"type": "conductor", "specular_reflectance": 0.5, **GOLD}),
        ),
        "roughconductor": scene(
            a=TILED,
            sky=upright,
            b={
                **FLOOR,
                "to_world": plate(1.2, 1.2, 1.0),
                "bsdf": {"type": "roughconductor", **GOLD, **ROUGH},
            },
        ),
        "roughconductor, brushed": scene(
            a=TILED,
            sky=upright,
            b={
                "type": "disk",
                "to_world": plate(1.2, 1.2, 1.0),
                "bsdf": {
                    "type": "roughconductor",
                    **GOLD,
                    "distribution": "ggx",
                    "alpha_u": 0.02,
                    "alpha_v": 0.06,
                },
            },
        ),
        # Facets scatter much light onto others here, and Mitsuba loses it.
        "roughconductor, very rough": scene(
            a=TILED,
            sky=upright,
            b=ball({"type": "roughconductor", **GOLD, "distribution": "ggx", "alpha": 0.7}),
        ),
        "roughconductor, beckmann": scene(a=TILED, sky=upright, b=ball({"type": "roughconductor", **GOLD})),
        "roughconductor, beckmann, very rough": scene(
            a=TILED,
            sky=upright,
            b=ball({"type": "roughconductor", **GOLD, "distribution": "beckmann", "alpha": 0.6}),
        ),
        "roughconductor, beckmann, brushed": scene(
            a=TILED,
            sky=upright,
            b={
                "type": "disk",
                "to_world": plate(1.2, 1.2, 1.0),
                "bsdf": {"type": "roughconductor", **GOLD, "alpha_u": 0.08, "alpha_v": 0.5},
            },
        ),
        "roughdielectric, very rough": scene(
            12,
            a=TILED,
            sky=SKY,
            b=ball({"type": "roughdielectric", "int_ior": 1.5, "distribution": "ggx", "alpha": 0.5}),
        ),
        "roughdielectric, beckmann": scene(12, a=TILED, sky=SKY, b=ball({"type": "roughdielectric"})),
        "roughdielectric, beckmann, very rough": scene(
            12,
            a=TILED,
            sky=SKY,
            b={
                "type": "rectangle",
                "to_world": plate(1.2, 1.2, 1.0),
                "bsdf": {
                    "type": "roughdielectric",
                    "int_ior": 1.8,
                    "alpha": 0.5,
                    "sample_visible": False,
                },
            },
        ),
        "roughplastic, very rough": scene(
            a=FLOOR,
            lamp=LAMP,
            sky=SKY,
            b=ball(
                {
                    "type": "roughplastic",
                    "diffuse_reflectance": rgb(0.1, 0.4, 0.8),
                    "distribution": "ggx",
                    "alpha": 0.5,
                    "nonlinear": True,
                }
            ),
        ),
        "roughplastic, beckmann": scene(
            a=FLOOR,
            lamp=LAMP,
            sky=SKY,
            b=ball({"type": "roughplastic", "diffuse_reflectance": rgb(0.1, 0.4, 0.8)}),
        ),
        "roughplastic, beckmann, very rough": scene(
            a=FLOOR,
            lamp=LAMP,
            sky=SKY,
            b=ball(
                {
                    "type": "roughplastic",
                    "diffuse_reflectance": rgb(0.1, 0.4, 0.8),
                    "int_ior": 1.8,
                    "alpha": 0.6,
                }
            ),
        ),
        "plastic": scene(
            a=FLOOR,
            b=ball({"type": "plastic", "diffuse_reflectance": rgb(0.1, 0.4, 0.8)}),
            lamp=LAMP,
            sky=SKY,
        ),
        "plastic, nonlinear": scene(
            a=TILED,
            sky=upright,
            b=ball(
                {
                    "type": "plastic",
                    "int_ior": 1.8,
                    "nonlinear": True,
                    "diffuse_reflectance": picture("colors.png", filter_type="nearest"),
                }
            ),
        ),
        "roughplastic": scene(
            a=FLOOR,
            lamp=LAMP,
            sky=SKY,
            b={
                "type": "rectangle",
                "to_world": plate(1.2, 1.2, 1.0),
                "bsdf": {"type": "roughplastic", "diffuse_reflectance": rgb(0.1, 0.4, 0.8), **ROUGH},
            },
        ),
        "twosided, of two": scene(
            a=FLOOR,
            lamp=LAMP,
            sky=SKY,
            b={
                "type": "cylinder",
                "p0": [0.3, -1, 0.8],
                "p1": [0, 1, 0.8],
                "radius": 0.7,
                "flip_normals": True,
                "bsdf": {"type": "twosided", "in": matt, "out": {"type": "plastic"}},
            },
        ),
        "sphere and cylinder that shine inwards": scene(
            6,
            a=FLOOR,
            b=ball(matt),
            dome={
                "type": "sphere",
                "radius": 7.0,
                "flip_normals": True,
                "bsdf": matt,
                "emitter": {"type": "area", "radiance": rgb(0.3, 0.4, 0.6)},
            },
            tube={
                "type": "cylinder",
                "p0": [1.2, -1.5, 0.2],
                "p1": [1.6, -0.8, 0.9],
                "radius": 0.5,
                "flip_normals": True,
                "emitter": {"type": "area", "radiance": rgb(6.0, 3.0, 1.0)},
            },
        ),
        "cube, rectangle and disk that shine backwards": scene(
            6,
            b=ball(matt),
            room={
                "type": "cube",
                "to_world": moved(0, 0, 4.0, 6.0, 20.0),
                "flip_normals": True,
                "bsdf": {"type": "diffuse", "reflectance": 0.6},
                "emitter": {"type": "area", "radiance": rgb(0.2, 0.25, 0.3)},
            },
            c={
                **LAMP,
                "to_world": matrix((-2, -1, 3), (1, 0, 0), (0, 1, 0), (0, 0, 1)),
                "flip_normals": True,
            },
            d={
                "type": "disk",
                "to_world": matrix((2, 0, 2), (0, 0, 1), (0, 1, 0), (1, 0, 0)),
                "flip_normals": True,
                "emitter": {"type": "area", "radiance": rgb(1.0, 4.0, 2.0)},
            },
        ),
        # Mitsuba's `path` (3.9.1) squares the opacity in light sampling.
        "mask": {
            **scene(
                a=TILED,
                lamp=LAMP,
                b=ball({"type": "mask", "opacity": checks(4.0, 3.0, a=0.9, b=0.2), "bsdf": sheet}),
                c={
                    "type": "rectangle",
                    "to_world": looking((-0.9, -1.2, 0.7), (0, -5, 2)),
                    "bsdf": {"type": "mask", "opacity": picture("colors.png", raw=True), "bsdf": matt},
                },
            ),
            "integrator": {"type": "volpath", "max_depth": -1},
        },
        # For materials with a smooth lobe, Mitsuba (3.9.1) mistakes the other material for a part of its
        # reflection.
        "blendbsdf": scene(
            a=FLOOR,
            b=ball({"type": "blendbsdf", "weight": picture("colors.png"), "one": matt, "two": sheet["bsdf"]}),
            lamp=LAMP,
            sky=SKY,
        ),
        "bumpmap": scene(
            2,
            a=FLOOR,
            lamp=LAMP,
            b={
                "type": "rectangle",
                "to_world": plate(1.0, 1.0, 1.0),
                "bsdf": {
                    "type": "bumpmap",
                    "scale": 0.15,
                    "height": picture("bumps.png", raw=True),
                    "bsdf": matt,
                },
            },
        ),
        "normalmap": scene(
            2,
            a=FLOOR,
            lamp=LAMP,
            b={
                "type": "rectangle",
                "to_world": plate(1.0, 1.0, 1.0),
                "bsdf": {
                    "type": "normalmap",
                    "normalmap": picture("normals.png", raw=True),
                    "bsdf": matt,
                },
            },
        ),
        # Both models agree for metal; Mitsuba's non-metals have Disney's diffuse lobe.
        "principled": scene(
            a=TILED,
            sky=upright,
            b={
                **FLOOR,
                "to_world": plate(1.2, 1.2, 1.0),
                "bsdf": {
                    "type": "principled",
                    "base_color": rgb(0.9, 0.6, 0.3),
                    "metallic": 1.0,
                    "roughness": 0.22,
                },
            },
        ),
        "thinlens": scene(
            a=TILED,
            b=ball(matt),
            lamp=LAMP,
            sensor={"type": "thinlens", "aperture_radius": 0.25, "focus_distance": 4.0},
        ),
        "orthographic, crop": scene(
            a=TILED,
            b=ball(matt),
            lamp=LAMP,
            sensor={
                "type": "orthographic",
                "to_world": matrix(
                    (0.5, -5.0, 2.5), *(np.array(EYE)[:3, k] for k in range(3)), (2.0, 2.0, 1.0)
                ),
                "film": {
                    "type": "hdrfilm",
                    "width": 48,
                    "height": 40,
                    "crop_width": SIZE,
                    "crop_height": SIZE,
                    "crop_offset_x": 10,
                    "crop_offset_y": 3,
                    "rfilter": {"type": "box"},
                },
            },
        ),
        "perspective, crop, principal point": scene(
            a=TILED,
            b=ball(matt),
            lamp=LAMP,
            sensor={
                "fov": 55.0,
                "fov_axis": "larger",
                "principal_point_offset_x": 0.1,
                "principal_point_offset_y": -0.05,
                "film": {
                    "type": "hdrfilm",
                    "width": 40,
                    "height": 48,
                    "crop_width": SIZE,
                    "crop_height": SIZE,
                    "crop_offset_x": 5,
                    "crop_offset_y": 12,
                    "rfilter": {"type": "box"},
                },
            },
        ),
        # Mitsuba omits samples beyond the film, and raywright has them: so the border is uniform.
        "gaussian": {
            **scene(
                2,
                b=ball(matt),
                sky=SKY,
                sensor={"focal_length": "50mm", "film": {"type": "hdrfilm", "width": SIZE, "height": SIZE}},
            )
        },
        "direct": {
            **scene(a=TILED, b=ball(matt), lamp=LAMP, sky=SKY),
            "integrator": {"type": "direct", "emitter_samples": 2, "bsdf_samples": 1},
        },
        "area, pictured": scene(
            a=FLOOR,
            b=ball({"type": "diffuse"}, emitter={"type": "area", "radiance": picture("colors.png")}),
        ),
        **extended(),
        **filled(),
        **spectral(),
    }
