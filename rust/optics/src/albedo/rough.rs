//! A roughness between two dielectrics: where light is lost there, and in what its tables are.

use super::variables::{EVEN, of_cosine, of_root, scale};
use glam::DVec3;

/// Facets of a roughness between a dielectric and one that is denser.
#[derive(Clone, Copy, Debug)]
pub struct Rough {
    pub alpha: f64,
    /// The part of x = μ / s(ω) in which light from the denser side is bent so far that it leaves the surface again, up
    /// to 1.
    pub bent: f64,
    /// The cosine of the critical angle.
    critical: f64,
    /// Losses next to the critical angle, where what gets through grazes the surface and other facets stop it.
    peak: f64,
    /// The root of the cosine up to which light is bent away.
    bent_root: f64,
    /// [`Rough::near`] at grazing, and by how much more it is straight on.
    span: [f64; 2],
}

impl Rough {
    /// Of the denser index over the other.
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

    /// What average losses are in units of.
    #[inline]
    pub fn unit(&self) -> f64 {
        self.alpha * self.alpha * self.bent
    }

    /// How far a cosine is from that of the critical angle on the scale of α, from −1 to 1, and how near, up to 1.
    #[inline]
    fn near(&self, cosine: f64) -> (f64, f64) {
        let off = cosine - self.critical;
        let scale = (off * off + self.alpha * self.alpha).sqrt().recip();
        (off * scale, self.alpha * scale)
    }

    /// A variable from 0 to 1 for light from the thinner side, and about how much of it is lost.
    #[inline]
    pub fn thin(&self, w: DVec3) -> (f64, f64) {
        let square = self.alpha * self.alpha;
        (of_cosine(self.alpha, w.z.abs()), self.unit() / (w.z * w.z + square * (w.x * w.x + w.y * w.y)))
    }

    /// The same for light from the denser side.
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
