//! Separable filters: a product of the same function of x and of y.

use super::Filter;
use std::fmt;

/// A filter along one axis, even in x. Its scale is arbitrary; its integral must not be 0.
pub trait FilterProfile: fmt::Debug + Send + Sync {
    /// The profile is 0 beyond this radius.
    fn radius(&self) -> f64;

    /// Value at 0 ≤ x ≤ radius.
    fn evaluate(&self, x: f64) -> f64;

    /// Minimum number of equal parts of the radius, chosen so that kinks and zeros lie between parts.
    fn parts(&self) -> usize {
        1
    }
}

/// A separable filter made of its profile.
///
/// Offsets have a density that is linear between the nodes of a table and equals |f| there. Its integral is inverted in
/// closed form. The weight f / density is exact, and its magnitude is constant to a thousandth wherever f is not near
/// 0. The map increases with u, so stratified numbers give stratified offsets.
#[derive(Clone)]
pub struct Separable<P> {
    profile: P,
    radius: f64,
    /// 1 over the integral of the profile.
    scale: f64,
    /// |f| at the nodes, scaled so that its interpolation integrates to 1.
    density: Vec<f64>,
    /// Integral of the density up to each node.
    cumulative: Vec<f64>,
    /// For equal steps of u, as many as there are cells, the last cell that begins at or before the step (Chen and
    /// Asau, 1974).
    guide: Vec<u16>,
}

impl<P: FilterProfile> Separable<P> {
    /// Minimum number of cells over the whole width.
    const CELLS: usize = 256;

    /// Tabulates a profile.
    pub fn new(profile: P) -> Self {
        let radius = profile.radius();
        let half = (Self::CELLS / 2).next_multiple_of(profile.parts());
        let cells = 2 * half;
        let step = radius / half as f64;
        let value = |node: usize| profile.evaluate(node.abs_diff(half) as f64 * step);
        let mut density: Vec<f64> = (0..=cells).map(|node| value(node).abs()).collect();
        let mut cumulative = vec![0.0; cells + 1];
        for cell in 0..cells {
            cumulative[cell + 1] = cumulative[cell] + 0.5 * (density[cell] + density[cell + 1]) * step;
        }
        let total = cumulative[cells];
        density.iter_mut().chain(&mut cumulative).for_each(|x| *x /= total);
        cumulative[cells] = 1.0;
        let guide = (0..cells)
            .map(|k| cumulative[..cells].partition_point(|&c| c <= k as f64 / cells as f64).saturating_sub(1) as u16)
            .collect();
        let integral = 2.0 * (0..half).map(|cell| quadrature(&profile, cell as f64 * step, step)).sum::<f64>();
        Self { radius, scale: 1.0 / integral, profile, density, cumulative, guide }
    }

    /// Value along one axis; integrates to 1.
    #[inline]
    pub fn along(&self, x: f64) -> f64 {
        if x.abs() <= self.radius { self.scale * self.profile.evaluate(x.abs()) } else { 0.0 }
    }

    /// Samples an offset along one axis for u in (0, 1); also returns its density.
    #[inline]
    fn draw(&self, u: f64) -> (f64, f64) {
        let cells = self.guide.len();
        let mut cell = usize::from(self.guide[((u * cells as f64) as usize).min(cells - 1)]);
        while cell + 1 < cells && self.cumulative[cell + 1] <= u {
            cell += 1;
        }
        let (low, high) = (self.density[cell], self.density[cell + 1]);
        let span = self.cumulative[cell + 1] - self.cumulative[cell];
        // Not exactly at a node, where the density and the filter may be 0.
        let share = ((u - self.cumulative[cell]) / span).clamp(1e-12, 1.0 - 1e-12);
        // Root of the quadratic, without cancellation.
        let root = ((1.0 - share) * low * low + share * high * high).sqrt();
        let within = (share * (low + high) / (low + root)).min(1.0);
        let half = 0.5 * cells as f64;
        let x = (cell as f64 + within - half) / half * self.radius;
        (x, low + within * (high - low))
    }
}

impl<P: fmt::Debug> fmt::Debug for Separable<P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Separable").field(&self.profile).finish()
    }
}

/// Integral of a profile over `start..start + step`, by the five-point Gauss-Legendre rule: exact up to degree 9.
fn quadrature(profile: &impl FilterProfile, start: f64, step: f64) -> f64 {
    const POINTS: [(f64, f64); 3] = [
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (0.906_179_845_938_664, 0.236_926_885_056_189_1),
    ];
    let at = |x: f64| profile.evaluate(start + 0.5 * step * (1.0 + x));
    let sum = POINTS[1..].iter().fold(POINTS[0].1 * at(0.0), |sum, &(x, weight)| sum + weight * (at(x) + at(-x)));
    0.5 * step * sum
}

impl<P: FilterProfile> Filter for Separable<P> {
    fn radius(&self) -> f64 {
        self.radius
    }

    fn evaluate(&self, x: f64, y: f64) -> f64 {
        self.along(x) * self.along(y)
    }

    #[inline]
    fn sample(&self, u: [f64; 2]) -> ([f64; 2], f64) {
        let [(x, of_x), (y, of_y)] = u.map(|u| self.draw(u));
        ([x, y], self.along(x) / of_x * (self.along(y) / of_y))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{BlackmanHarris, Gaussian, Lanczos, Mitchell, Triangle};
    use super::*;

    /// Integrals over u of the weight and of the weight times the offset, along one axis.
    fn moments<P: FilterProfile>(filter: &Separable<P>) -> [f64; 2] {
        // By midpoints within each cell, because weights have kinks between cells.
        const STEPS: u32 = 1024;
        let mut moments = [0.0; 2];
        for ends in filter.cumulative.windows(2) {
            if ends[0] == ends[1] {
                continue;
            }
            let step = (ends[1] - ends[0]) / f64::from(STEPS);
            for i in 0..STEPS {
                let (x, density) = filter.draw(ends[0] + (f64::from(i) + 0.5) * step);
                let weight = filter.along(x) / density;
                moments[0] += weight * step;
                moments[1] += weight * x * step;
            }
        }
        moments
    }

    fn assert_moments<P: FilterProfile>(profile: P) {
        let filter = Separable::new(profile);
        let [mean, first] = moments(&filter);
        // The midpoint rule has an error of at most 1/24 of the squared step times the second derivative.
        assert!((mean - 1.0).abs() < 1e-8, "{filter:?}: {mean}");
        assert!(first.abs() < 1e-13 * filter.radius(), "{filter:?}: {first}");
    }

    #[test]
    fn weights_have_mean_1_and_offsets_mean_0() {
        for radius in [0.5, 1.7, 64.0] {
            assert_moments(Triangle::new(radius).unwrap());
            assert_moments(BlackmanHarris::new(radius).unwrap());
            assert_moments(Gaussian::new(radius, 0.5).unwrap());
            for (b, c) in [(1.0 / 3.0, 1.0 / 3.0), (1.0, 0.0), (0.0, 0.5), (0.0, 1.0), (0.0, 0.0), (1.0, 1.0)] {
                assert_moments(Mitchell::new(radius, b, c).unwrap());
            }
        }
        for lobes in [1, 2, 3, 7, 16] {
            assert_moments(Lanczos::new(lobes).unwrap());
        }
    }
}
