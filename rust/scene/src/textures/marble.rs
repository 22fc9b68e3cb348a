//! Marble.

use super::periodic_functions::sine;
use super::{Domain, Needs, Octaves, Pattern, TexturePoint};
use std::f64::consts::TAU;

/// Marble: veins across the x axis with period 1, distorted by noise (Perlin, "An Image Synthesizer", 1985). Veins
/// below the footprint fade to their mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Marble {
    /// Domain.
    pub domain: Domain,
    /// Amplitude of the distortion, in units.
    pub distortion: f64,
    /// The noise.
    pub octaves: Octaves,
}

impl Pattern for Marble {
    #[inline]
    fn amount(&self, point: &TexturePoint) -> f64 {
        let place = self.domain.place(point);
        let size = place.size();
        let bent = place.point.x + self.distortion * self.octaves.sum(place.point, size);
        // Standard deviation of the veins' phase over the footprint (that of a uniform distribution is its width over
        // √12). The phase is approximately Gaussian, which attenuates the sine by this factor.
        let spread = TAU * size * self.distortion * self.octaves.slope(size);
        let left = (-spread * spread / 24.0).exp();
        0.5 + 0.5 * sine(bent, place.widths.x) * left
    }

    fn needs(&self) -> Needs {
        self.domain.needs()
    }
}

#[cfg(test)]
mod tests {
    use super::super::ObjectTransform;
    use super::*;
    use raywright_base::math::DVec3;

    #[test]
    fn without_distortion_it_is_a_sine() {
        let marble =
            Marble { domain: Domain::Object(ObjectTransform::default()), distortion: 0.0, octaves: Octaves::default() };
        for i in -20..20 {
            let x = f64::from(i) * 0.17;
            let at = |size| TexturePoint { position: DVec3::new(x, 0.3, -2.0), size, ..TexturePoint::default() };
            assert!((marble.amount(&at(0.0)) - 0.5 - 0.5 * (TAU * x).sin()).abs() < 1e-12);
            assert!((marble.amount(&at(1.0)) - 0.5).abs() < 1e-12);
        }
    }

    #[test]
    fn veins_too_fine_to_see_fade() {
        let domain = Domain::Object(ObjectTransform::default());
        let marble = Marble { domain, distortion: 3.0, octaves: Octaves::default() };
        let spread = |size: f64| {
            (0..500)
                .map(|i| {
                    let position = DVec3::new(f64::from(i) * 0.37, f64::from(i) * 0.21, f64::from(i) * 0.11);
                    (marble.amount(&TexturePoint { position, size, ..TexturePoint::default() }) - 0.5).abs()
                })
                .sum::<f64>()
                / 500.0
        };
        // The mean absolute deviation of a sine is 2/π of its amplitude.
        assert!((spread(0.0) - std::f64::consts::FRAC_1_PI).abs() < 0.03, "{}", spread(0.0));
        assert!(spread(0.4) < 0.1 * spread(0.0));
    }
}
