//! Filters cropped at the edges of the film.

use super::Filter;
use std::boxed::Box as Boxed;

/// Another filter; near the edge of the film, pixels renormalize its part within the film.
#[derive(Debug)]
pub struct Cropped(pub Boxed<dyn Filter>);

impl Filter for Cropped {
    fn radius(&self) -> f64 {
        self.0.radius()
    }

    fn evaluate(&self, x: f64, y: f64) -> f64 {
        self.0.evaluate(x, y)
    }

    fn sample(&self, u: [f64; 2]) -> ([f64; 2], f64) {
        self.0.sample(u)
    }

    fn is_cropped(&self) -> bool {
        true
    }
}

/// The part of a filter along one axis that lies within the film, for a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
struct CroppedAxis {
    /// Range of random numbers that sample it.
    ends: [f64; 2],
    /// Its integral.
    integral: f64,
}

impl CroppedAxis {
    const WHOLE: Self = Self { ends: [0.0, 1.0], integral: 1.0 };

    /// Computes the part for a pixel whose center is at these distances from the ends of the film.
    fn new(filter: &dyn Filter, to_ends: [f64; 2]) -> Self {
        let radius = filter.radius();
        if to_ends.iter().all(|&to| to >= radius) {
            return Self::WHOLE;
        }
        let [low, high] = [-to_ends[0].min(radius), to_ends[1].min(radius)];
        // Offsets increase with u, so bisection converges.
        let number_of = |offset: f64| {
            let [mut below, mut above] = [0.0, 1.0];
            for _ in 0..60 {
                let middle = 0.5 * (below + above);
                let [x, _] = filter.sample([middle, 0.5]).0;
                *(if x < offset { &mut below } else { &mut above }) = middle;
            }
            above
        };
        let ends =
            [if low > -radius { number_of(low) } else { 0.0 }, if high < radius { number_of(high) } else { 1.0 }];
        Self { ends, integral: integral(filter, low, high) / integral(filter, -radius, radius) }
    }
}

/// Integral of a filter along x at y = 0.
fn integral(filter: &dyn Filter, low: f64, high: f64) -> f64 {
    // By midpoints, several between kinks.
    const STEPS: u32 = 1 << 12;
    let step = (high - low) / f64::from(STEPS);
    (0..STEPS).map(|i| filter.evaluate(low + (f64::from(i) + 0.5) * step, 0.0)).sum::<f64>() * step
}

/// Cropping of a separable filter for every row and column of a film.
#[derive(Debug)]
pub struct FilmCropping([Vec<CroppedAxis>; 2]);

impl FilmCropping {
    /// Computes the cropping for a film size; `None` if the edges have no effect.
    pub fn new(filter: &dyn Filter, size: [u32; 2]) -> Option<Self> {
        let part = |pixel: u32, size: u32| {
            let centre = f64::from(pixel) + 0.5;
            CroppedAxis::new(filter, [centre, f64::from(size) - centre])
        };
        filter.is_cropped().then(|| Self(size.map(|size| (0..size).map(|pixel| part(pixel, size)).collect())))
    }

    /// Maps a point of the unit square so that a pixel's sample lies within the film. Also returns the factor on its
    /// weight.
    pub fn on_film(&self, pixel: [u32; 2], u: [f64; 2]) -> ([f64; 2], f64) {
        let parts = [0, 1].map(|axis| self.0[axis][pixel[axis] as usize]);
        let weight = parts.iter().map(|part| (part.ends[1] - part.ends[0]) / part.integral).product();
        ([0, 1].map(|axis| parts[axis].ends[0] + u[axis] * (parts[axis].ends[1] - parts[axis].ends[0])), weight)
    }

    /// Share of a pixel's filter within the film.
    pub fn share(&self, [x, y]: [u32; 2]) -> f64 {
        self.0[0][x as usize].integral * self.0[1][y as usize].integral
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Box, Gaussian, Mitchell, Separable};
    use super::*;

    #[test]
    fn what_is_drawn_lies_on_the_film_and_weighs_1() {
        let bell = || Separable::new(Gaussian::new(2.0, 0.5).unwrap());
        let ringing = || Separable::new(Mitchell::new(2.0, 1.0 / 3.0, 1.0 / 3.0).unwrap());
        let flat = Box::new(1.5).unwrap();
        let filters: [Boxed<dyn Filter>; 3] = [Boxed::new(bell()), Boxed::new(ringing()), Boxed::new(flat)];
        for filter in filters.map(Cropped) {
            // Far from the ends of y, where the center's weight is the square root of that on both axes.
            let edges = FilmCropping::new(&filter, [7, 9]).unwrap();
            let middle = filter.sample([0.5; 2]).1.sqrt();
            for (column, way) in [(0, 1.0), (1, 1.0), (3, 0.0), (6, -1.0)] {
                const STEPS: u32 = 1 << 15;
                let (mut weights, mut mean) = (0.0, 0.0);
                for i in 0..STEPS {
                    let u = [(f64::from(i) + 0.5) / f64::from(STEPS), 0.5];
                    let (u, factor) = edges.on_film([column, 4], u);
                    let ([x, _], weight) = filter.sample(u);
                    assert!((-1e-9..=7.0 + 1e-9).contains(&(f64::from(column) + 0.5 + x)), "{x}");
                    weights += weight * factor / middle / f64::from(STEPS);
                    mean += weight * factor / middle * x / f64::from(STEPS);
                }
                assert!((weights - 1.0).abs() < 2e-4, "{filter:?} {column} {weights}");
                // The centroid of the remaining part is shifted inwards, unless the removed part was negative.
                if column != 1 {
                    assert!((mean.abs() > 0.05) == (way != 0.0) && mean * way >= 0.0, "{filter:?} {column} {mean}");
                }
            }
        }
    }

    #[test]
    fn far_from_edges_nothing_changes() {
        let filter = Cropped(Boxed::new(Separable::new(Gaussian::new(2.0, 0.5).unwrap())));
        let edges = FilmCropping::new(&filter, [9, 9]).unwrap();
        assert_eq!(edges.on_film([4, 4], [0.3, 0.7]), ([0.3, 0.7], 1.0));
        assert_eq!(edges.share([4, 4]), 1.0);
        // Half a pixel and one and a half from the edge, by the Gaussian minus its value at its radius.
        let part = |to: f64| CroppedAxis::new(&filter, [to, 9.0]).integral;
        let bell = |x: f64| (-2.0 * x * x).exp() - (-8f64).exp();
        let at = |low: f64, i: i32| bell(low + (f64::from(i) + 0.5) * (2.0 - low) / 4e3);
        let sum = |low: f64| (0..4000).map(|i| at(low, i)).sum::<f64>() * (2.0 - low);
        for to in [0.5, 1.5] {
            assert!((part(to) - sum(-to) / sum(-2.0)).abs() < 1e-9);
        }
        assert!(FilmCropping::new(&*filter.0, [9, 9]).is_none());
    }
}
