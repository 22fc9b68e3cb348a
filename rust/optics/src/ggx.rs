//! The GGX facet distribution.

use super::Facets;
use raywright_base::math::trig::sin_cos_turn;
use raywright_base::math::{DVec3, in_lanes};
use std::f64::consts::FRAC_1_PI;

/// The distribution of slopes of Trowbridge and Reitz (1975), later named GGX (Walter et al., "Microfacet Models for
/// Refraction through Rough Surfaces", 2007): facets oriented like the surface of an ellipsoid. Here s(ω) = √(z² + αx²
/// x² + αy² y²).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx {
    alpha: [f64; 2],
}

in_lanes! {
    /// GGX facets, one per lane.
    GgxLanes of Ggx { alpha: [f64; 2] }
}

impl Facets for Ggx {
    #[inline]
    fn new(alpha: [f64; 2]) -> Self {
        Self { alpha: alpha.map(|a| a.clamp(Self::SMOOTH, 1.0)) }
    }

    #[inline(always)]
    fn with(alpha: [f64; 2]) -> Self {
        Self { alpha }
    }

    #[inline(always)]
    fn alpha(&self) -> [f64; 2] {
        self.alpha
    }

    #[inline(always)]
    fn density(&self, h: DVec3) -> f64 {
        let [ax, ay] = self.alpha;
        let (x, y) = (h.x / ax, h.y / ay);
        let square = x * x + y * y + h.z * h.z;
        FRAC_1_PI / (ax * ay * square * square)
    }

    /// From the unnormalized half vector, with α² divided out. With q = wo + wi and p = αx αy the density is |q|⁴ p³ /
    /// (π (αy² qx² + αx² qy² + p² qz²)²), and the cosine is |q| / 2.
    #[inline(always)]
    fn mirroring(&self, wo: DVec3, wi: DVec3) -> (f64, f64) {
        let ([ax, ay], q) = (self.alpha, wo + wi);
        let square = q.length_squared();
        let product = ax * ay;
        let (x, y, z) = (ay * q.x, ax * q.y, product * q.z);
        let root = square * product / (x * x + y * y + z * z);
        let (density, cosine) = (FRAC_1_PI * product * (root * root), (0.5 * square.sqrt()).min(1.0));
        // The sum of nearly opposite directions in the tangent plane has no accurate direction. Both cases are
        // computed, because lanes have no branches.
        let is_flat = square < 1e-60;
        (if is_flat { self.density(DVec3::Z) } else { density }, if is_flat { wo.z } else { cosine })
    }

    /// |z| √(1 + α² tan² θ).
    #[inline(always)]
    fn stretch(&self, w: DVec3) -> f64 {
        let [ax, ay] = self.alpha;
        let (x, y) = (ax * w.x, ay * w.y);
        (x * x + y * y + w.z * w.z).sqrt()
    }

    /// From a stretched direction the facets are a hemisphere of mirrors, which reflect to a uniform spherical cap
    /// (Dupuy and Benyoub, "Sampling Visible GGX Normals with Spherical Caps", 2023).
    #[inline(always)]
    fn sample_visible(&self, wo: DVec3, u: [f64; 2]) -> DVec3 {
        let [ax, ay] = self.alpha;
        let w = DVec3::new(ax * wo.x, ay * wo.y, wo.z) / self.stretch(wo);
        // The cap has heights from −w.z to 1. Its direction plus w has height (1 − u) (1 + w.z), written without
        // cancellation.
        let depth = u[1] * (1.0 + w.z);
        let radius = (depth * (2.0 - depth)).max(0.0).sqrt();
        let [sin, cos] = sin_cos_turn(u[0]);
        let h = DVec3::new(ax * (radius * cos + w.x), ay * (radius * sin + w.y), (1.0 - u[1]) * (1.0 + w.z));
        h.normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    #[test]
    fn facets_cover_the_surface() {
        // ∫ D cos θ dω = 1, with t = r² / (1 + r²) of the slope r in units of α.
        for alpha in [[0.001; 2], [0.1; 2], [1.0; 2], [0.02, 0.7]] {
            let (ggx, steps) = (Ggx::new(alpha), 64);
            let mut sum = 0.0;
            for i in 0..steps * steps {
                let (t, turn) = ((f64::from(i / steps) + 0.5) / 64.0, f64::from(i % steps) / 64.0 * TAU);
                let r = (t / (1.0 - t)).sqrt();
                let h = DVec3::new(alpha[0] * r * turn.cos(), alpha[1] * r * turn.sin(), 1.0).normalize();
                let solid = alpha[0] * alpha[1] * PI / (1.0 - t).powi(2) * h.z.powi(3);
                sum += ggx.density(h) * h.z * solid / 4096.0;
            }
            assert!((sum - 1.0).abs() < 1e-12, "{alpha:?} {sum}");
        }
    }

    #[test]
    fn facets_that_mirror_are_those_of_the_half_vector() {
        let direction = |height: f64, turn: f64| {
            let radius = (1.0 - height * height).sqrt();
            DVec3::new(radius * turn.cos(), radius * turn.sin(), height)
        };
        let heights = [1.0, 0.9, 0.5, 0.1, 1e-3, 1e-9];
        for alpha in [[Ggx::SMOOTH; 2], [0.01; 2], [0.3; 2], [1.0; 2], [1e-3, 0.7]] {
            let ggx = Ggx::new(alpha);
            for (wo, turn) in heights.iter().flat_map(|&z| [0.0, 1.0, 3.0, PI].map(|turn| (direction(z, 0.3), turn))) {
                let wi = direction(0.7 * wo.z, 0.3 + turn);
                let h = (wo + wi).normalize();
                let (density, cosine) = ggx.mirroring(wo, wi);
                // A half vector is accurate to 10⁻¹⁶ over its unnormalized length, and the density to that over a
                // lobe's width.
                let known = 1e-15 / (wo + wi).length();
                assert!(
                    (density / ggx.density(h) - 1.0).abs() < 1e-13 + 16.0 * known / alpha[0],
                    "{alpha:?} {wo} {wi}"
                );
                assert!((cosine - wo.dot(h)).abs() < 1e-15 + known, "{wo} {wi}");
            }
        }
        // The half vector of two opposite directions in the plane is meaningless; the density at the normal is used.
        let (wo, wi) = (DVec3::new(1.0, 0.0, 1e-90), DVec3::new(-1.0, 0.0, 1e-90));
        assert_eq!(Ggx::new([0.3; 2]).mirroring(wo, wi), (Ggx::new([0.3; 2]).density(DVec3::Z), 1e-90));
    }

    #[test]
    fn masking_is_smiths() {
        // 2 / (1 + √(1 + α² tan² θ)) (Walter et al., 2007).
        let truths = [(0.1, 0.5, 0.9926104339481299), (0.5, 0.5, 0.8610017480861207), (1.0, 0.5, 2.0 / 3.0)];
        let grazing = [(1.0, 0.1, 0.18181818181818182), (0.5, 0.01, 0.039209920542121704)];
        for (alpha, cosine, truth) in truths.into_iter().chain(grazing) {
            let w = DVec3::new(0.0, f64::sqrt(1.0 - cosine * cosine), cosine);
            assert!((Ggx::new([alpha; 2]).masking(w) - truth).abs() < 1e-14);
        }
    }

    #[test]
    fn one_scattering_has_its_albedo() {
        // Quadratures of E(μ) for white facets; compare Kulla and Conty (2017), Heitz et al. (2016).
        let truths = [
            (0.1, [0.98830, 0.96929, 0.88346]),
            (0.3, [0.87737, 0.82171, 0.88881]),
            (0.5, [0.68785, 0.69825, 0.86011]),
        ];
        for (alpha, albedos) in truths {
            for (cosine, truth) in [1.0, 0.5, 0.1].into_iter().zip(albedos) {
                let (ggx, wo) = (Ggx::new([alpha; 2]), DVec3::new(f64::sqrt(1.0 - cosine * cosine), 0.0, cosine));
                let (steps, mut sum) = (400, 0.0);
                for i in 0..steps * steps {
                    let (t, v) = ((f64::from(i / steps) + 0.5) / 400.0, (f64::from(i % steps) + 0.5) / 400.0);
                    let wi = ggx.sample_reflection(wo, [v, 1.0 - t.powi(4)]);
                    if wi.z > 0.0 {
                        sum += 4.0 * t.powi(3) * ggx.reflection_geometry(wo, wi) * 2.0 * (wo.z + ggx.stretch(wo));
                    }
                }
                let albedo = sum / f64::from(steps * steps);
                assert!((albedo - truth).abs() < 1e-4, "{alpha} {cosine} {albedo}");
            }
        }
    }
}
