//! Stripes.

use super::periodic_functions::pulse;
use super::{Domain, Needs, Pattern, TexturePoint};

/// Stripes across the x axis with period 1, box-filtered in closed form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stripes {
    /// Domain.
    pub domain: Domain,
    /// Share of each period, at its end, that is 1; between 0 and 1.
    pub fraction: f64,
}

impl Pattern for Stripes {
    #[inline]
    fn amount(&self, point: &TexturePoint) -> f64 {
        let place = self.domain.place(point);
        1.0 - pulse(place.point.x, place.widths.x, 1.0 - self.fraction)
    }

    fn mean(&self) -> f64 {
        self.fraction
    }

    fn needs(&self) -> Needs {
        self.domain.needs()
    }
}

#[cfg(test)]
mod tests {
    use super::super::UvTransform;
    use super::*;

    #[test]
    fn stripes_cover_their_share() {
        let stripes = |fraction| Stripes { domain: Domain::Uv(UvTransform::default()), fraction };
        let at = |u, width| TexturePoint { uv: [u, 0.3], width, ..TexturePoint::default() };
        for u in [-2.0, 0.0, 5.0] {
            assert_eq!(stripes(0.25).amount(&at(u + 0.7, 0.0)), 0.0);
            assert_eq!(stripes(0.25).amount(&at(u + 0.8, 0.0)), 1.0);
            // Half of the interval from 0.65 to 0.85 is beyond 0.75.
            assert!((stripes(0.25).amount(&at(u + 0.75, 0.2)) - 0.5).abs() < 1e-14);
            assert!((stripes(0.25).amount(&at(u + 0.1, 3.0)) - 0.25).abs() < 1e-14);
            assert_eq!((stripes(0.0).amount(&at(u + 0.9, 0.5)), stripes(1.0).amount(&at(u + 0.1, 0.5))), (0.0, 1.0));
        }
    }
}
