"""More small scenes in Mitsuba's format: principled materials, curves, attributes, thrown pictures."""

from mitsuba_parts import (
    FLOOR,
    LAMP,
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

ABOVE = looking((0.3, -0.5, 4.0), (0.0, 0.2, 0.0), (0, 1, 0))


def extended():
    """Return the scenes, as dicts, by name. The files that they name are `mitsuba_files.write_files`'s."""
    sheet = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": rgb(0.2, 0.5, 0.7)}}
    clay = {
        "type": "principled",
        "base_color": rgb(0.7, 0.3, 0.1),
        "roughness": 0.4,
        "metallic": 0.4,
        "anisotropic": 0.5,
        "spec_tint": 0.3,
        "sheen": 0.6,
        "sheen_tint": 0.4,
        "flatness": 0.3,
        "clearcoat": 0.7,
        "clearcoat_gloss": 0.3,
        "specular": 0.6,
    }
    glass = {
        "type": "principled",
        "base_color": rgb(0.9, 0.7, 0.5),
        "roughness": 0.5,
        "spec_trans": 0.8,
        "eta": 1.4,
    }
    leaf = {
        "type": "principledthin",
        "base_color": rgb(0.6, 0.7, 0.3),
        "roughness": 0.6,
        "spec_trans": 0.4,
        "diff_trans": 0.9,
        "sheen": 0.3,
        "spec_tint": 0.2,
        "eta": 1.3,
    }
    dabs = {"type": "diffuse", "reflectance": {"type": "mesh_attribute", "name": "vertex_color"}}
    tiles = {"type": "diffuse", "reflectance": {"type": "mesh_attribute", "name": "face_color", "scale": 0.8}}
    shared = {
        "type": "blendbsdf",
        "weight": {"type": "mesh_attribute", "name": "face_share"},
        "a": {"type": "diffuse", "reflectance": rgb(0.1, 0.2, 0.6)},
        "b": {"type": "diffuse", "reflectance": rgb(0.8, 0.7, 0.1)},
    }
    high = moved(0, 0, 1)
    return {
        "principled": scene(3, a=TILED, b=ball(clay), lamp=LAMP, sky=SKY),
        "principled, textured": scene(
            3,
            a=FLOOR,
            b=ball({**clay, "roughness": 0.7, "metallic": checks(4.0, 2.0, a=0.9, b=0.1)}),
            lamp=LAMP,
        ),
        "principled, glass": scene(6, a=TILED, b=ball(glass), sky=SKY),
        "principledthin": scene(
            4,
            a=TILED,
            b={"type": "rectangle", "to_world": plate(1.0, 1.0, 1.0), "bsdf": leaf},
            lamp=LAMP,
            sky=SKY,
        ),
        "spot, pictured": scene(
            2,
            a=FLOOR,
            spot={
                "type": "spot",
                "to_world": ABOVE,
                "intensity": rgb(20.0, 18.0, 16.0),
                "texture": picture("colors.png"),
                "cutoff_angle": 35.0,
                "beam_width": 20.0,
            },
        ),
        "projector": scene(
            2,
            a=FLOOR,
            thrown={
                "type": "projector",
                "to_world": ABOVE,
                "irradiance": picture("colors.png"),
                "scale": 6.0,
                "fov": 50.0,
            },
        ),
        "linearcurve": scene(
            a=FLOOR,
            b={"type": "linearcurve", "filename": "curve.txt", "to_world": high, "bsdf": sheet},
            sky=SKY,
        ),
        "bsplinecurve": scene(
            a=FLOOR,
            b={"type": "bsplinecurve", "filename": "spline.txt", "to_world": high, "bsdf": sheet},
            sky=SKY,
        ),
        "serialized": scene(
            a=FLOOR,
            b={
                "type": "serialized",
                "filename": "gem.serialized",
                "shape_index": 1,
                "face_normals": True,
                "to_world": matrix((0, 0, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1)),
                "bsdf": {"type": "diffuse", "reflectance": checks(4.0, 4.0)},
            },
            sky=SKY,
            lamp=LAMP,
        ),
        "ply, colors of vertices": scene(
            b={"type": "ply", "filename": "dabs.ply", "to_world": high, "face_normals": True, "bsdf": dabs},
            sky=SKY,
        ),
        "ply, colors of faces": scene(
            b={"type": "ply", "filename": "dabs.ply", "to_world": high, "face_normals": True, "bsdf": tiles},
            sky=SKY,
        ),
        "ply, shares of faces": scene(
            b={"type": "ply", "filename": "dabs.ply", "to_world": high, "face_normals": True, "bsdf": shared},
            sky=SKY,
        ),
        "direct, lights": {
            **scene(a=TILED, b=ball({"type": "diffuse"}), lamp=LAMP, sky=SKY),
            "integrator": {"type": "direct", "emitter_samples": 1, "bsdf_samples": 0},
        },
        "direct, surfaces": {
            **scene(
                a=TILED,
                b=ball({"type": "diffuse"}),
                lamp=LAMP,
                sky=SKY,
                p={"type": "point", "position": [0.0, 0.0, 5.0]},
            ),
            "integrator": {"type": "direct", "emitter_samples": 0, "bsdf_samples": 1},
        },
    }
