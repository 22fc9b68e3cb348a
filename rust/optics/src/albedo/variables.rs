//! Table variables, each from 0 to 1.

use crate::{Facets, Ggx};

/// Greatest relative index of refraction in the tables; greater ones are clamped.
pub const DENSEST: f64 = 10.0;

/// Variable for a cosine with a characteristic scale, both given by their square roots. It is dense at grazing
/// incidence, where shares vary as square roots.
#[inline]
pub fn of_root(cosine: f64, scale: f64) -> f64 {
    (1.0 + scale) * cosine / (cosine + scale)
}

/// Variable for a cosine of light that facets of a roughness reflect, or of light from the thinner side.
#[inline]
pub fn of_cosine(alpha: f64, cosine: f64) -> f64 {
    // The rougher the surface, the more variation there is away from grazing.
    let even = EVEN * alpha;
    even * cosine + (1.0 - even) * of_root(cosine.sqrt(), alpha.sqrt())
}

/// Linear share of the variable at α = 1.
pub const EVEN: f64 = 0.3;

/// Variable for a roughness.
#[inline]
pub fn of_alpha(alpha: f64) -> f64 {
    let least = Ggx::SMOOTH.sqrt();
    (alpha.sqrt() - least) / (1.0 - least)
}

/// Roughness of a variable.
#[cfg(test)]
pub fn alpha(variable: f64) -> f64 {
    let least = Ggx::SMOOTH.sqrt();
    (least + variable * (1.0 - least)).powi(2)
}

/// Variable for a roughness if the function varies as α ln α near 0.
#[inline]
pub fn of_alpha_root(alpha: f64) -> f64 {
    let least = Ggx::SMOOTH.cbrt();
    (alpha.cbrt() - least) / (1.0 - least)
}

/// Roughness of that variable.
#[cfg(test)]
pub fn alpha_of_root(variable: f64) -> f64 {
    let least = Ggx::SMOOTH.cbrt();
    (least + variable * (1.0 - least)).powi(3)
}

/// w / α with w = √(η² − 1), for a relative index of refraction η ≥ 1. The onset of reflection towards grazing is at a
/// cosine of about w, and it varies on the scale of α.
#[inline]
pub fn scale(alpha: f64, eta: f64) -> f64 {
    ((eta - 1.0) * (eta + 1.0)).max(0.0).sqrt() / alpha
}

/// Variable for a relative index of refraction from 1 to [`DENSEST`] at a roughness.
#[inline]
pub fn of_index(alpha: f64, eta: f64) -> f64 {
    let variable = |eta| 1.0 - (1.0 + scale(alpha, eta)).cbrt().recip();
    variable(eta) / variable(DENSEST)
}

/// Relative index of refraction of a variable at a roughness. The loss vanishes at 1, so the smallest index is slightly
/// above 1, where the loss in its unit has reached its limit.
#[cfg(test)]
pub fn index(alpha: f64, variable: f64) -> f64 {
    let top = 1.0 - (1.0 + scale(alpha, DENSEST)).cbrt().recip();
    let scale = (1.0 - variable * top).powi(-3) - 1.0;
    (alpha * scale.max(0.003)).hypot(1.0)
}

/// Approximate cosine on the facets that reflect to a direction with this cosine; at grazing incidence, that of a facet
/// with slope α.
#[inline]
pub fn effective_cosine(alpha: f64, cosine: f64) -> f64 {
    let square = FACET_SLOPE * alpha * alpha;
    ((cosine * cosine + square) / (1.0 + square)).sqrt()
}

/// Fitted so that the tables of differences from [`effective_cosine`]'s reflectance are flattest.
const FACET_SLOPE: f64 = 0.6;
