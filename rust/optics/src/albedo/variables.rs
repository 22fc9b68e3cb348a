//! The variables that tables go by, each from 0 to 1.

use crate::{Facets, Ggx};

/// What counts as the greatest index of refraction: facets of a greater one lose as if they were of this.
pub const DENSEST: f64 = 10.0;

/// For a cosine that matters on a scale, both given by their roots: dense at grazing, where shares go as roots.
#[inline]
pub fn of_root(cosine: f64, scale: f64) -> f64 {
    (1.0 + scale) * cosine / (cosine + scale)
}

/// For a cosine of light that facets of a roughness reflect, or of light from the thinner side.
#[inline]
pub fn of_cosine(alpha: f64, cosine: f64) -> f64 {
    // The rougher, the more happens away from grazing.
    let even = EVEN * alpha;
    even * cosine + (1.0 - even) * of_root(cosine.sqrt(), alpha.sqrt())
}

/// How much of a variable goes evenly by the cosine, at α = 1.
pub const EVEN: f64 = 0.3;

/// For a roughness.
#[inline]
pub fn of_alpha(alpha: f64) -> f64 {
    let least = Ggx::SMOOTH.sqrt();
    (alpha.sqrt() - least) / (1.0 - least)
}

/// The roughness of a variable.
#[cfg(test)]
pub fn alpha(variable: f64) -> f64 {
    let least = Ggx::SMOOTH.sqrt();
    (least + variable * (1.0 - least)).powi(2)
}

/// For a roughness where what happens near none goes as α ln α.
#[inline]
pub fn of_alpha_root(alpha: f64) -> f64 {
    let least = Ggx::SMOOTH.cbrt();
    (alpha.cbrt() - least) / (1.0 - least)
}

/// The roughness of that variable.
#[cfg(test)]
pub fn alpha_of_root(variable: f64) -> f64 {
    let least = Ggx::SMOOTH.cbrt();
    (least + variable * (1.0 - least)).powi(3)
}

/// w / α with w = √(η² − 1), for an index of refraction η ≥ 1: about w is the cosine at which reflection sets in
/// towards grazing, and it matters on the scale of α.
#[inline]
pub fn scale(alpha: f64, eta: f64) -> f64 {
    ((eta - 1.0) * (eta + 1.0)).max(0.0).sqrt() / alpha
}

/// For an index of refraction from 1 to [`DENSEST`] at a roughness.
#[inline]
pub fn of_index(alpha: f64, eta: f64) -> f64 {
    let variable = |eta| 1.0 - (1.0 + scale(alpha, eta)).cbrt().recip();
    variable(eta) / variable(DENSEST)
}

/// The index of refraction of a variable at a roughness. In place of 1, where nothing is lost, stands one so near to it
/// that what is lost does not change any more in units of what is.
#[cfg(test)]
pub fn index(alpha: f64, variable: f64) -> f64 {
    let top = 1.0 - (1.0 + scale(alpha, DENSEST)).cbrt().recip();
    let scale = (1.0 - variable * top).powi(-3) - 1.0;
    (alpha * scale.max(0.003)).hypot(1.0)
}

/// About the cosine at which facets are met that reflect to a direction of this cosine: at grazing, that of a slope of
/// α.
#[inline]
pub fn effective_cosine(alpha: f64, cosine: f64) -> f64 {
    let square = FACET_SLOPE * alpha * alpha;
    ((cosine * cosine + square) / (1.0 + square)).sqrt()
}

/// What makes the tables of what differs from [`effective_cosine`]'s reflectance the flattest.
const FACET_SLOPE: f64 = 0.6;
