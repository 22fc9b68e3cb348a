//! Single-scattering energy loss of anisotropic, perfectly reflecting facets.

use super::Tables;
use super::cubic::Cubic;
use super::tables::{BRUSHED, BRUSHED_AVERAGE};
use super::variables::{EVEN, of_alpha, of_root};
use glam::DVec3;

/// Greatest ratio of both roughnesses in the table; a greater ratio is clamped.
pub const STEEPEST: f64 = 1e3;

/// Ratio of the lesser to the greater roughness for a variable, the inverse of [`of_ratio`].
#[cfg(test)]
pub fn ratio(variable: f64) -> f64 {
    (1.0 - variable * (1.0 - STEEPEST.sqrt().recip())).powi(2)
}

/// Facets of two roughnesses. The table position is recomputed at each lookup, which keeps materials small; few are
/// anisotropic.
#[derive(Clone, Copy, Debug)]
pub struct Brushed {
    tables: &'static Tables,
    /// The lesser and the greater roughness.
    alpha: [f64; 2],
    /// True if the lesser is along y.
    turned: bool,
    /// One over the logarithm of their ratio.
    scale: f64,
}

impl Brushed {
    /// Looks up the roughnesses along x and y in these tables.
    pub fn new(tables: &'static Tables, [x, y]: [f64; 2]) -> Self {
        let rough = x.max(y);
        let smooth = x.min(y).max(rough / STEEPEST);
        Self {
            tables,
            alpha: [smooth, rough],
            turned: y < x,
            // With equal roughnesses all azimuths are equivalent.
            scale: if of_ratio(smooth, rough) > 1e-9 { (rough / smooth).ln().recip() } else { 0.0 },
        }
    }

    /// Loss for direction `w`, as [`super::MirrorLoss::of`].
    #[inline(never)]
    pub fn of(&self, w: DVec3) -> f64 {
        let [a, b] = self.alpha;
        let (x, y, z) = (w.x * w.x, w.y * w.y, w.z * w.z);
        let (x, y) = if self.turned { (y, x) } else { (x, y) };
        let (across, plane) = (a * a * x + b * b * y, x + y);
        let along = if plane > 0.0 { (across / plane).sqrt() } else { b };
        let azimuth = Cubic::new(of_along(along, self.alpha, self.scale), BRUSHED[1]);
        let cosine = Cubic::new(of_cosine(along, b, w.z.abs()), BRUSHED[0]);
        let (ratio, rough) = (Cubic::new(of_ratio(a, b), BRUSHED[2]), Cubic::new(of_alpha(b), BRUSHED[3]));
        let most = (across + z * mean_square(self.alpha)) / (across + z);
        (most * self.tables.brushed.at(&cosine, &azimuth, &ratio, &rough)).clamp(0.0, 1.0)
    }

    /// Cosine-weighted average of the loss.
    pub fn average(&self) -> f64 {
        let [a, b] = self.alpha;
        let ratio = Cubic::new(of_ratio(a, b), BRUSHED_AVERAGE[0]);
        let rough = Cubic::new(of_alpha(b), BRUSHED_AVERAGE[1]);
        self.tables.brushed_average.at(&ratio, &rough).exp() * mean_square(self.alpha)
    }
}

#[inline]
pub fn mean_square([a, b]: [f64; 2]) -> f64 {
    0.5 * (a * a + b * b)
}

/// Table variable from 0 to 1 for the ratio of both roughnesses.
#[inline]
pub fn of_ratio(smooth: f64, rough: f64) -> f64 {
    (1.0 - (smooth / rough).sqrt()) / (1.0 - STEEPEST.sqrt().recip())
}

/// Table variable from 0 to 1 for a cosine, where `along` is the roughness at its azimuth and `rough` the greatest.
#[inline]
pub fn of_cosine(along: f64, rough: f64, cosine: f64) -> f64 {
    let (root, even) = (cosine.sqrt(), EVEN * rough);
    even * cosine + (1.0 - even) * 0.5 * (of_root(root, along.sqrt()) + of_root(root, rough.sqrt()))
}

/// Table variable from 0 to 1 for the roughness at an azimuth. The mean of a logarithmic variable, which resolves the
/// smoother direction, and a linear one, which resolves the rougher direction. `scale` is one over the logarithm of the
/// ratio.
#[inline]
pub fn of_along(along: f64, [smooth, rough]: [f64; 2], scale: f64) -> f64 {
    if scale == 0.0 { 0.5 } else { 0.5 * ((along / smooth).ln() * scale + (along - smooth) / (rough - smooth)) }
}
