"""Scenes in Mitsuba's format from dicts to XML."""

from xml.sax.saxutils import quoteattr

import numpy as np

TAGS = {
    "bsdf": "diffuse dielectric roughdielectric thindielectric conductor roughconductor plastic roughplastic "
    "null principled principledthin twosided blendbsdf mask bumpmap normalmap",
    "shape": "sphere disk rectangle cube cylinder obj ply serialized linearcurve "
    "bsplinecurve shapegroup instance",
    "emitter": "area point spot projector directional constant envmap",
    "texture": "bitmap checkerboard mesh_attribute",
    "sensor": "perspective thinlens orthographic",
    "film": "hdrfilm",
    "rfilter": "box",
    "sampler": "independent",
    "integrator": "path volpath direct",
    "spectrum": "blackbody d65 regular irregular",
    "medium": "homogeneous heterogeneous",
    "volume": "gridvolume constvolume",
    "phase": "hg rayleigh isotropic",
}
TAG_OF = {kind: tag for tag, kinds in TAGS.items() for kind in kinds.split()}


def numbers(values):
    return " ".join(repr(float(x)) for x in np.ravel(values))


def xml(tree, name=None):
    """A scene as lines of XML."""
    kind = tree["type"]
    called = f" name={quoteattr(name)}" if name else ""
    if kind == "ref":
        return [f"<ref id={quoteattr(tree['id'])}{called}/>"]
    if kind == "rgb":
        return [f'<rgb{called} value="{numbers(tree["value"])}"/>']
    if kind == "spectrum":
        pairs = " ".join(f"{float(nm)!r}:{float(value)!r}" for nm, value in tree["value"])
        return [f'<spectrum{called} value="{pairs}"/>']
    lines = ['<scene version="3.0.0">'] if kind == "scene" else []
    if kind != "scene":
        own = f" id={quoteattr(name)}" if kind == "shapegroup" else called
        lines = [f"<{TAG_OF[kind]} type={quoteattr(kind)}{own}>"]
    for key, value in tree.items():
        if key == "type":
            continue
        if isinstance(value, dict):
            lines += xml(value, key)
            continue
        at = f"name={quoteattr(key)}"
        if key in ("to_world", "to_uv"):
            lines.append(f'<transform {at}><matrix value="{numbers(value)}"/></transform>')
        elif isinstance(value, list):
            lines.append(f'<vector {at} value="{numbers(value)}"/>')
        else:
            tag = {bool: "boolean", int: "integer", float: "float", str: "string"}[type(value)]
            lines.append(
                f"<{tag} {at} value={quoteattr(str(value).lower() if tag == 'boolean' else str(value))}/>"
            )
    return [*lines, f"</{TAG_OF.get(kind, kind)}>"]
