//! The integrals in the tables.

use crate::{Facets, fresnel};
use glam::DVec3;

/// Number of points over the facets' slope and azimuth. Refraction is discontinuous at lines between facets, whose
/// shape requires the many slopes. Means are accurate to 10⁻⁴, and mostly to 10⁻⁵.
const STEPS: [usize; 2] = [2500, 32];

/// Reflection is smoother.
const FEWER: [usize; 2] = [800, 32];

/// Mean of a function of the normal over the facets visible from `w`. By symmetry half the azimuths suffice if `w` is
/// in the xz plane.
fn mean_over_facets(facets: &impl Facets, w: DVec3, steps: [usize; 2], value: impl Fn(DVec3) -> f64) -> f64 {
    let azimuths = if w.y == 0.0 { 0.5 } else { 1.0 };
    let mut sum = 0.0;
    for i in 0..steps[0] {
        // 1 − u = s² stretches the tail of the distribution, and s = t² concentrates points where lobes meet the
        // horizon.
        let t = (i as f64 + 0.5) / steps[0] as f64;
        let s = t * t;
        // Rows are offset by the golden ratio, so that no discontinuity is aligned with the points.
        let shift = (i as f64 * 0.618_033_988_749_894_9).fract();
        let point = |j: usize| [(j as f64 + shift) / steps[1] as f64 * azimuths, 1.0 - s * s];
        let row: f64 = (0..steps[1]).map(|j| value(facets.sample_visible(w, point(j)))).sum();
        sum += 4.0 * s * t * row;
    }
    sum / (steps[0] * steps[1]) as f64
}

/// G₂ / G₁(wo) of a reflection, 0 below the horizon.
fn reflected(facets: &impl Facets, wo: DVec3, h: DVec3) -> f64 {
    let wi = h * (2.0 * wo.dot(h)) - wo;
    if wi.z > 0.0 { facets.reflection_geometry(wo, wi) * 4.0 * wo.z / facets.masking(wo) } else { 0.0 }
}

/// G₂ / G₁(wo) of a refraction, 0 if it ends on the side of `wo`.
fn refracted(facets: &impl Facets, wo: DVec3, h: DVec3, eta: f64) -> f64 {
    match fresnel::refract(wo, h, eta) {
        Some(wi) if wi.z < 0.0 => (facets.masking(wi) / facets.masking(wo)).min(1.0),
        _ => 0.0,
    }
}

/// 1 − directional albedo of perfectly reflecting facets.
pub fn mirror_loss(facets: &impl Facets, w: DVec3) -> f64 {
    mean_over_facets(facets, w, FEWER, |h| 1.0 - reflected(facets, w, h))
}

/// 1 − directional albedo of reflection and refraction; `w` is above, and `eta` is the index of refraction below over
/// that above.
pub fn interface_loss(facets: &impl Facets, eta: f64, w: DVec3) -> f64 {
    mean_over_facets(facets, w, STEPS, |h| {
        let f = fresnel::dielectric(w.dot(h), eta);
        f * (1.0 - reflected(facets, w, h)) + (1.0 - f) * (1.0 - refracted(facets, w, h, eta))
    })
}

/// Directional albedo of facets whose reflectance is a function of the cosine.
pub fn reflected_share(facets: &impl Facets, w: DVec3, reflectance: impl Fn(f64) -> f64) -> f64 {
    mean_over_facets(facets, w, FEWER, |h| reflectance(w.dot(h)) * reflected(facets, w, h))
}

/// The direction in the xz plane with a cosine.
pub fn direction(cosine: f64) -> DVec3 {
    DVec3::new(((1.0 - cosine) * (1.0 + cosine)).sqrt(), 0.0, cosine)
}

/// Inverts an increasing function on [0, 1].
pub fn inverse(at: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if f(middle) < at { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Cosine-weighted average ∫ f(μ) 2μ dμ of a function that falls off at most as 1 / μ² beyond a scale, by midpoints of
/// ln μ.
pub fn even_light(scale: f64, f: impl Fn(f64) -> f64) -> f64 {
    const STEPS: usize = 2000;
    // The contribution from below is negligible.
    let least = 1e-4 * scale;
    let step = least.ln() / STEPS as f64;
    let term = |i: usize| {
        let cosine = (step * (i as f64 + 0.5)).exp();
        2.0 * cosine * cosine * f(cosine)
    };
    (0..STEPS).map(term).sum::<f64>() * -step + f(least) * least * least
}
