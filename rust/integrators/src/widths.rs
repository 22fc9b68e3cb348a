//! How wide the bundle of neighboring rays is along a path.

use raywright_optics::BsdfSample;
use raywright_scene::Footprint;

/// The bundle of rays after a surface of mean curvature `curvature`, where it is so wide.
///
/// A mirror of mean curvature H, seen by a bundle of width w, spreads it by 2Hw (Akenine-Möller et al., "Improved
/// Shader and Texture Level of Detail Using Ray Cones", 2021), and refraction by as much as it bends; a direction drawn
/// with density p has its neighbors, if some 256 are drawn for a pixel, about 1/√(256 p) away (after Suykens and
/// Willems, "Path Differentials and Applications", 2001).
pub(crate) fn widened(before: &Footprint, width: f64, curvature: f64, next: &BsdfSample) -> Footprint {
    let bent = if next.is_through {
        before.spread / next.eta + curvature * width * (1.0 / next.eta - 1.0)
    } else {
        before.spread + 2.0 * curvature * width
    };
    let scattered = 1.0 / (16.0 * next.pdf.sqrt());
    Footprint { width, spread: if scattered > 0.0 { bent.abs().max(scattered) } else { bent } }
}
