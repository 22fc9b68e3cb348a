//! A homogeneous medium.

use super::stretch::{Content, Stretch};
use super::{Coefficients, Medium, Stretches};
use raywright_base::math::{DVec3, Ray};
use raywright_optics::{Phase, Rgb};

/// A homogeneous medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Homogeneous {
    coefficients: Coefficients,
    phase: Phase,
}

impl Homogeneous {
    /// Creates a medium from absorption, scattering and emission. `None` if one of them is negative or not finite.
    pub fn new(absorption: Rgb, scattering: Rgb, emission: Rgb, phase: Phase) -> Option<Self> {
        let coefficients = Coefficients::new(absorption, scattering, emission);
        (absorption.is_radiance() && coefficients.is_physical()).then_some(Self { coefficients, phase })
    }
}

impl Medium for Homogeneous {
    fn phase(&self) -> Phase {
        self.phase
    }

    fn scatters(&self) -> bool {
        !self.coefficients.scattering.is_black()
    }

    fn glows(&self) -> bool {
        !self.coefficients.emission.is_black()
    }

    fn is_even(&self) -> bool {
        true
    }

    fn stretches(&self, _ray: &Ray, [_, end]: [f64; 2]) -> Stretches<'_> {
        Stretches::whole(Stretch { end, content: Content::Even(self.coefficients) })
    }

    fn at(&self, _point: DVec3) -> Coefficients {
        self.coefficients
    }

    fn bytes(&self) -> usize {
        size_of::<Self>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_what_is_no_coefficient() {
        let new =
            |absorption, scattering, emission| Homogeneous::new(absorption, scattering, emission, Phase::Rayleigh);
        for bad in [-1.0, f64::NAN, f64::INFINITY] {
            let bad = Rgb::new(0.0, bad, 0.0);
            assert_eq!(new(bad, Rgb::ONE * 2.0, Rgb::ZERO), None);
            assert_eq!(new(Rgb::ZERO, bad, Rgb::ZERO), None);
            assert_eq!(new(Rgb::ZERO, Rgb::ZERO, bad), None);
        }
        let haze = new(Rgb::ONE, Rgb::ZERO, Rgb::ZERO).unwrap();
        assert!(!haze.scatters() && new(Rgb::ZERO, Rgb::ONE, Rgb::ZERO).unwrap().scatters());
    }
}
