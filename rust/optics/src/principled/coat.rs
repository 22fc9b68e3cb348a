//! The clear coat of the principled models.

use crate::{Facets, Ggx, Rgb, fresnel};
use raywright_base::math::exponential::exp;
use raywright_base::math::trig::sin_cos_turn;
use raywright_base::math::{DVec3, in_lanes};
use std::f64::consts::PI;

/// A facet distribution with very long tails, for coats: GTR with exponent 1 (Burley, 2012).
#[derive(Clone, Copy, Debug)]
pub(super) struct Gtr1 {
    /// α², and its logarithm.
    square: f64,
    log: f64,
}

in_lanes! {
    /// Such distributions, one per lane.
    Gtr1Lanes of Gtr1 { square: f64, log: f64 }
}

impl Gtr1 {
    /// Reflectance of the coat at normal incidence, and the roughness of its masking term.
    pub(super) const COAT: f64 = 0.04;
    pub(super) const MASKED: f64 = 0.25;

    pub(super) fn new(alpha: f64) -> Self {
        let square = alpha * alpha;
        Self { square, log: square.ln() }
    }

    /// Creates the distribution from a coat's gloss, 0 to 1.
    pub(super) fn of_gloss(gloss: f64) -> Self {
        Self::new(0.1 + (0.001 - 0.1) * gloss)
    }

    /// Value of a full coat between two directions above, with its cosine, from the density of the mirroring facets and
    /// the cosine to both.
    #[inline(always)]
    pub(super) fn reflected(&self, density: f64, cosine: f64, [o, i]: [DVec3; 2]) -> f64 {
        let masked = Ggx::new([Self::MASKED; 2]);
        fresnel::schlick(cosine, Rgb::splat(Self::COAT))[0] * density * masked.masking(o) * masked.masking(i) * i.z
    }

    /// Coefficients of a quarter of [`Gtr1::albedo`], a polynomial in the cosine. They are linear in 1 / ln α². They
    /// were fitted to integrals for α from 0.001 to 0.1, with an error of at most 0.0004.
    #[inline(always)]
    fn terms(&self) -> [f64; 6] {
        const EVEN: [f64; 6] = [-0.03265, 0.81227, -2.94051, 4.50073, -3.106, 0.80561];
        const SLOPE: [f64; 6] = [0.53358, -4.92009, 15.6992, -23.12837, 15.96907, -4.21768];
        let width = -1.0 / self.log;
        std::array::from_fn(|k| 4.0 * (EVEN[k] + SLOPE[k] * width))
    }

    /// Directional albedo of a full coat for a cosine.
    #[inline(always)]
    pub(super) fn albedo(&self, cosine: f64) -> f64 {
        self.terms().into_iter().rev().fold(0.0, |sum, term| (sum + term) * cosine).max(0.0)
    }

    /// Cosine-weighted average of the albedo.
    #[inline(always)]
    pub(super) fn albedo_average(&self) -> f64 {
        self.terms().into_iter().enumerate().map(|(k, term)| 2.0 * term / (k as f64 + 3.0)).sum()
    }

    #[inline(always)]
    pub(super) fn density(&self, h: DVec3) -> f64 {
        let square = self.square;
        (square - 1.0) / (PI * self.log * (1.0 + (square - 1.0) * h.z * h.z))
    }

    /// Samples a normal with density D cos θ.
    #[inline(always)]
    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        let height = ((1.0 - exp(self.log * (1.0 - u[1]))) / (1.0 - self.square)).clamp(0.0, 1.0);
        let [sin, cos] = sin_cos_turn(u[0]);
        let radius = (1.0 - height).sqrt();
        DVec3::new(radius * cos, radius * sin, height.sqrt())
    }
}
