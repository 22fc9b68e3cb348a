//! A medium that is the same everywhere.

use super::{HenyeyGreenstein, Medium, MediumSample};
use crate::math::Ray;
use crate::optics::Rgb;

/// A medium that is the same everywhere: light is dimmed by Beer's and Lambert's law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Homogeneous {
    absorption: Rgb,
    scattering: Rgb,
    phase: HenyeyGreenstein,
}

impl Homogeneous {
    /// A medium by its coefficients of absorption and scattering, each per unit of length. `None` if one is negative or
    /// not finite.
    pub fn new(absorption: Rgb, scattering: Rgb, phase: HenyeyGreenstein) -> Option<Self> {
        let is_coefficient = Rgb::is_radiance;
        (is_coefficient(absorption) && is_coefficient(scattering)).then_some(Self { absorption, scattering, phase })
    }

    fn extinction(&self) -> Rgb {
        self.absorption + self.scattering
    }

    /// What is left after a distance, which may be infinite.
    fn left(&self, distance: f64) -> Rgb {
        // 0 times infinity is no number: where nothing dims, all is left.
        self.extinction().map(|sigma| if sigma == 0.0 { 1.0 } else { (-sigma * distance).exp() })
    }
}

impl Medium for Homogeneous {
    fn transmittance(&self, ray: &Ray, _u: f64) -> Rgb {
        self.left(ray.t_max - ray.t_min)
    }

    /// By the extinction of one channel, each equally likely: the weight is over the mean density of all three, and so
    /// at most 3 however much they differ.
    fn sample_distance(&self, ray: &Ray, choice: f64, u: f64) -> MediumSample {
        let extinction = self.extinction();
        let chosen = extinction[((choice * 3.0) as usize).min(2)];
        let distance = if chosen > 0.0 { -(-u).ln_1p() / chosen } else { f64::INFINITY };
        let way = ray.t_max - ray.t_min;
        if distance < way {
            let left = self.left(distance);
            let density = (extinction * left).mean();
            MediumSample { t: Some(ray.t_min + distance), weight: self.scattering * left / density }
        } else {
            let left = self.left(way);
            MediumSample { t: None, weight: left / left.mean() }
        }
    }

    fn phase(&self) -> HenyeyGreenstein {
        self.phase
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DVec3;
    use crate::sampling::Sampler;

    fn medium(absorption: Rgb, scattering: Rgb) -> Homogeneous {
        Homogeneous::new(absorption, scattering, HenyeyGreenstein::new(0.0).unwrap()).unwrap()
    }

    fn way(length: f64) -> Ray {
        Ray { t_min: 2.0, t_max: 2.0 + length, ..Ray::new(DVec3::ZERO, DVec3::X) }
    }

    #[test]
    fn dims_by_beers_and_lamberts_law_from_thin_to_thick() {
        for (depth, expected) in [(1e-6, 0.999_999_000_000_5), (1.0, (-1f64).exp()), (1e3, 0.0)] {
            // e⁻¹⁰⁰⁰ is below what f64 holds.
            let medium = medium(Rgb::splat(0.25 * depth), Rgb::splat(0.75 * depth));
            let left = medium.transmittance(&way(1.0), 0.5);
            assert!((left - expected).abs().max() <= 1e-15, "{depth}: {left}");
        }
        assert_eq!(medium(Rgb::ZERO, Rgb::ZERO).transmittance(&way(f64::INFINITY), 0.5), Rgb::ONE);
        assert_eq!(medium(Rgb::ONE, Rgb::ZERO).transmittance(&way(f64::INFINITY), 0.5), Rgb::ZERO);
    }

    #[test]
    fn draws_give_what_gets_through_and_what_is_scattered() {
        // What gets through is e^-τ, what is scattered once the albedo times the rest, channel by channel. Four
        // standard errors of the mean, which chance exceeds once in 16,000 cases; 18 cases.
        let albedo = Rgb::new(0.2, 0.9, 0.5);
        for depth in [1e-6, 0.3, 1e3] {
            let extinction = Rgb::new(0.5, 1.0, 2.0) * depth;
            let medium = medium(extinction * (Rgb::ONE - albedo), extinction * albedo);
            let count = 40_000;
            let [mut through, mut scattered] = [[Rgb::ZERO; 2]; 2];
            for number in 0..count {
                let mut sampler = Sampler::new(9, 0, number);
                let drawn = medium.sample_distance(&way(1.0), sampler.one(0), sampler.one(1));
                assert!(drawn.weight.is_finite() && drawn.weight.max() <= 3.0 + 1e-12);
                assert!(drawn.t.is_none_or(|t| (2.0..=3.0).contains(&t)));
                let sums = if drawn.t.is_some() { &mut scattered } else { &mut through };
                sums[0] += drawn.weight;
                sums[1] += drawn.weight * drawn.weight;
            }
            let left = medium.transmittance(&way(1.0), 0.0);
            for (sums, expected) in [(through, left), (scattered, albedo * (Rgb::ONE - left))] {
                let [mean, square] = sums.map(|sum| sum / f64::from(count));
                let error = ((square - mean * mean).at_least(Rgb::ZERO) / f64::from(count)).map(f64::sqrt);
                // Where something is too rare to be drawn, three draws of weight 3 are no surprise.
                let rare = 9.0 / f64::from(count);
                assert!(((mean - expected).abs() - 4.0 * error).max() < rare, "{depth}: {mean}, not {expected}");
            }
        }
    }

    #[test]
    fn refuses_what_is_no_coefficient() {
        let phase = HenyeyGreenstein::new(0.5).unwrap();
        for bad in [-1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(Homogeneous::new(Rgb::new(0.0, bad, 0.0), Rgb::ONE, phase), None);
            assert_eq!(Homogeneous::new(Rgb::ZERO, Rgb::new(0.0, 0.0, bad), phase), None);
        }
    }
}
