//! Scaling of the tables for an interface between two dielectrics.

use super::variables::{EVEN, of_cosine, of_root, scale};
use glam::DVec3;

/// Facets of a roughness between a dielectric and a denser one.
#[derive(Clone, Copy, Debug)]
pub struct Rough {
    pub alpha: f64,
    /// Value of x = μ / s(ω), up to 1, below which light from the denser side is refracted so strongly that it leaves
    /// the surface again.
    pub bent: f64,
    /// Cosine of the critical angle.
    critical: f64,
    /// Height of the loss peak near the critical angle, where transmitted light grazes the surface and other facets
    /// block it.
    peak: f64,
    /// Square root of the cosine up to which light leaves again.
    bent_root: f64,
    /// [`Rough::near`] at grazing incidence, and its increase towards normal incidence.
    span: [f64; 2],
}

impl Rough {
    /// Computes the scaling for a relative index of refraction, denser over thinner.
    pub fn new(alpha: f64, eta: f64) -> Self {
        let square = scale(alpha, eta) * scale(alpha, eta);
        let bent = square / (2.0 + square);
        let critical = scale(alpha, eta) * alpha / eta;
        let peak = 0.6 * bent * (alpha / alpha.hypot(critical)).powf(1.5);
        let mut rough = Self { alpha, bent, critical, peak, bent_root: (alpha * bent).sqrt(), span: [0.0; 2] };
        let low = rough.near(0.0).0;
        rough.span = [low, rough.near(1.0).0 - low];
        rough
    }

    /// Unit of average losses.
    #[inline]
    pub fn unit(&self) -> f64 {
        self.alpha * self.alpha * self.bent
    }

    /// Signed distance of a cosine from that of the critical angle on the scale of α, from −1 to 1, and the closeness,
    /// up to 1.
    #[inline]
    fn near(&self, cosine: f64) -> (f64, f64) {
        let off = cosine - self.critical;
        let scale = (off * off + self.alpha * self.alpha).sqrt().recip();
        (off * scale, self.alpha * scale)
    }

    /// Table variable from 0 to 1 for light from the thinner side, and the approximate loss.
    #[inline]
    pub fn thin(&self, w: DVec3) -> (f64, f64) {
        let square = self.alpha * self.alpha;
        (of_cosine(self.alpha, w.z.abs()), self.unit() / (w.z * w.z + square * (w.x * w.x + w.y * w.y)))
    }

    /// Table variable from 0 to 1 for light from the denser side, and the approximate loss.
    #[inline]
    pub fn dense(&self, w: DVec3) -> (f64, f64) {
        let (cosine, square) = (w.z.abs(), self.alpha * self.alpha);
        let stretch = (cosine * cosine + square * (w.x * w.x + w.y * w.y)).sqrt();
        let (far, near) = self.near(cosine);
        let most = self.unit() / (stretch * (stretch * self.bent + cosine)) + self.peak * near;
        let even = EVEN * self.alpha;
        let uneven = 0.5 * (of_root(cosine.sqrt(), self.bent_root) + (far - self.span[0]) / self.span[1]);
        (even * cosine + (1.0 - even) * uneven, most)
    }
}
