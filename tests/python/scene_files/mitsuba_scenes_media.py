"""Small scenes with media in Mitsuba's format."""

from mitsuba_parts import FLOOR, LAMP, SKY, ball, matrix, rgb, scene

NULL = {"type": "null"}


def filled():
    """Return the scenes, as dicts, by name. The files that they name are `mitsuba_files.write_files`'s."""
    # The unit cube around the ball.
    place = matrix((-1, -1, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (2.0, 2.0, 2.0))
    around = {"type": "cube", "to_world": matrix((0, 0, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1))}
    grid = {"type": "gridvolume", "filename": "puff.vol", "to_world": place}
    shades = {"type": "gridvolume", "filename": "shades.vol", "to_world": place}
    plain = {
        "type": "homogeneous",
        "sigma_t": rgb(0.25, 0.5, 1.0),
        "scale": 1.6,
        "albedo": rgb(0.9, 0.6, 0.3),
        "phase": {"type": "hg", "g": 0.4},
    }
    air = {"type": "homogeneous", "sigma_t": rgb(0.7), "albedo": rgb(0.8), "phase": {"type": "rayleigh"}}
    smoke = {"type": "heterogeneous", "sigma_t": grid, "albedo": rgb(0.9, 0.6, 0.3), "scale": 2.0}
    marble = {"type": "heterogeneous", "sigma_t": grid, "albedo": shades, "scale": 1.5}
    dyed = {"type": "heterogeneous", "sigma_t": shades, "albedo": rgb(0.8), "scale": 2.0}
    everywhere = {"type": "constvolume", "value": 1.2, "to_world": place}
    even = {"type": "heterogeneous", "sigma_t": everywhere, "albedo": shades}
    made = {
        "homogeneous, null": scene(a=FLOOR, b=ball(NULL, interior=plain), lamp=LAMP),
        "homogeneous, thindielectric": scene(
            a=FLOOR, b=ball({"type": "thindielectric", "int_ior": 1.5}, interior=air), sky=SKY
        ),
        "homogeneous, dielectric": scene(
            a=FLOOR, b=ball({"type": "dielectric", "int_ior": 1.3}, interior=air), sky=SKY
        ),
        "gridvolume": scene(a=FLOOR, b={**around, "bsdf": NULL, "interior": smoke}, lamp=LAMP),
        "gridvolume, albedo": scene(a=FLOOR, b={**around, "bsdf": NULL, "interior": marble}, sky=SKY),
        "gridvolume, three channels": scene(a=FLOOR, b={**around, "bsdf": NULL, "interior": dyed}, sky=SKY),
        "constvolume, albedo": scene(a=FLOOR, b={**around, "bsdf": NULL, "interior": even}, sky=SKY),
    }
    return {name: {**one, "integrator": {"type": "volpath", "max_depth": 5}} for name, one in made.items()}
