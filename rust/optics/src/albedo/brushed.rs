//! What facets of perfect mirrors lose that are rougher along one direction than along the other.

use super::Tables;
use super::cubic::Cubic;
use super::tables::{BRUSHED, BRUSHED_AVERAGE};
use super::variables::{EVEN, of_alpha, of_root};
use glam::DVec3;

/// How many times as rough a surface may be one way as the other: where it is rougher still, it loses as if it were
/// not.
pub const STEEPEST: f64 = 1e3;

/// How many times as smooth one way as the other facets of a variable are, as [`of_ratio`] has it.
#[cfg(test)]
pub fn ratio(variable: f64) -> f64 {
    (1.0 - variable * (1.0 - STEEPEST.sqrt().recip())).powi(2)
}

/// Facets of two roughnesses. Where they are in the table is found anew each time: materials stay small so, and few
/// are brushed.
#[derive(Clone, Copy, Debug)]
pub struct Brushed {
    tables: &'static Tables,
    /// The lesser and the greater roughness.
    alpha: [f64; 2],
    /// Whether the lesser is that along y.
    turned: bool,
    /// Over the logarithm of one over the other.
    scale: f64,
}

impl Brushed {
    /// Of the roughness along x and y.
    pub fn new(tables: &'static Tables, [x, y]: [f64; 2]) -> Self {
        let rough = x.max(y);
        let smooth = x.min(y).max(rough / STEEPEST);
        Self {
            tables,
            alpha: [smooth, rough],
            turned: y < x,
            // Of all but the same roughness no azimuth differs from another.
            scale: if of_ratio(smooth, rough) > 1e-9 { (rough / smooth).ln().recip() } else { 0.0 },
        }
    }

    /// Of light from `w`, as [`super::MirrorLoss::of`].
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

    /// Its mean over even light.
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

/// A variable from 0 to 1 for the lesser roughness beside the greater.
#[inline]
pub fn of_ratio(smooth: f64, rough: f64) -> f64 {
    (1.0 - (smooth / rough).sqrt()) / (1.0 - STEEPEST.sqrt().recip())
}

/// A variable from 0 to 1 for a cosine at an azimuth at which this is the roughness, where the greatest is `rough`.
#[inline]
pub fn of_cosine(along: f64, rough: f64, cosine: f64) -> f64 {
    let (root, even) = (cosine.sqrt(), EVEN * rough);
    even * cosine + (1.0 - even) * 0.5 * (of_root(root, along.sqrt()) + of_root(root, rough.sqrt()))
}

/// A variable from 0 to 1 for the roughness at an azimuth between the lesser and the greater: by its logarithm, for
/// what happens along the lesser, and evenly, for what does along the greater. `scale` is one over the logarithm of one
/// over the other.
#[inline]
pub fn of_along(along: f64, [smooth, rough]: [f64; 2], scale: f64) -> f64 {
    if scale == 0.0 { 0.5 } else { 0.5 * ((along / smooth).ln() * scale + (along - smooth) / (rough - smooth)) }
}
