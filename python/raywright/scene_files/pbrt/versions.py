"""The version of pbrt of a file."""

from __future__ import annotations

import re

# Directives, types and parameters of versions 2 and 3 that version 4 does not have.
_COMMENT = re.compile(r"#[^\n]*")
_VERSION_2 = re.compile(
    r"\b(SurfaceIntegrator|VolumeIntegrator|VolumeRegion|Volume|Renderer)\s+\""
    r"|\bMaterial\s+\"(shinymetal|measured)\""
    r"|\bAreaLightSource\s+\"area\""
)
_EITHER = re.compile(
    r"\bWorldEnd\b"
    r"|\bFilm\s+\"image\""
    r"|\bMaterial\s+\"(matte|plastic|metal|glass|mirror|uber|substrate|translucent|disney|fourier|kdsubsurface)\""
    r"|\"string type\"\s*\[?\s*\"(matte|plastic|metal|glass|mirror|uber|substrate|translucent|disney|fourier"
    r"|kdsubsurface)\""
    r"|\bTexture\s+\"[^\"]*\"\s+\"color\""
    r"|\bIntegrator\s+\"(directlighting|whitted)\""
    r"|\bCamera\s+\"environment\""
    r"|\bSampler\s+\"(lowdiscrepancy|02sequence|maxmindist|random|bestcandidate|adaptive)\""
    r"|\bShape\s+\"(cone|heightfield|heightfield2|hyperboloid|nurbs|paraboloid)\""
    r"|\"string mapname\""
)
_VERSION_3 = re.compile(r"\b(MakeNamedMedium|MediumInterface)\b|\bIntegrator\s+\"")


def older(text: str) -> str | None:
    """Return the older version of pbrt that a file is of; None if nothing in it says so."""
    plain = _COMMENT.sub("", text)
    if _VERSION_2.search(plain):
        return "pbrt-v2"
    if _EITHER.search(plain):
        return "pbrt-v3" if _VERSION_3.search(plain) else "pbrt-v2 or v3"
    return None
