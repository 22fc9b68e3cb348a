//! RGB reflectance of measured metals.

use crate::spectra::{Illuminant, Response};
use crate::{Rgb, fresnel};
use std::fmt;

/// RGB reflectance of a conductor with a spectral index of refraction, in linear Rec. 709 under daylight.
///
/// Fresnel's reflectance at each wavelength is integrated under daylight (D65), so that a perfect reflector is (1, 1,
/// 1). White light on gold becomes (1.022, 0.782, 0.344) at normal incidence, as in spectral renderers with a daylight
/// white point. Under an equal-energy illuminant, which is (1.20, 0.95, 0.91), it would be (1.20, 0.75, 0.31).
///
/// A channel may exceed 1, as gold's red does: its orange is outside the gamut, so red exceeds the incident light and
/// green is too low. That is right for one reflection, but its powers would grow without bound in a closed box,
/// although gold reflects at most 96.2 % at any wavelength from 400 to 700 nm. So multiple scattering within a rough
/// surface is summed by wavelength ([`Curve::seen`]), and paths that go from one such metal to another apply the factor
/// [`Curve::repeat_correction`].
pub struct Curve {
    /// At equally spaced cosines of incidence from 0 to 1.
    values: Box<[Rgb; Self::STEPS + 1]>,
    lines: Vec<CurveLine>,
    again: Rgb,
}

/// A representative wavelength.
#[derive(Clone, Copy, Debug)]
struct CurveLine {
    weight: Rgb,
    eta: f64,
    k: f64,
    /// Cosine-weighted average of its reflectance.
    mean: f64,
}

impl Curve {
    /// With this number of steps of the cosine, linear interpolation is within 0.03 % of the reflectance.
    const STEPS: usize = 256;

    /// Distance of representative wavelengths in nm. For gold, whose reflectance has the sharpest edge, the error is
    /// 0.05 %.
    const APART: u32 = 5;

    /// Computes the curve from η and k as functions of the visible wavelength.
    pub fn new(index: impl Fn(f64) -> (f64, f64)) -> Self {
        let mut lines = Vec::new();
        let mut brightest: f64 = 0.0;
        for (wavelength, weight) in Response::new(Illuminant::Daylight, Self::APART).weights() {
            let (eta, k) = index(wavelength);
            let mean = mean(|cosine| at(cosine, eta, k));
            // Outside this range the eye's response is negligible.
            if (400.0..=700.0).contains(&wavelength) {
                brightest = brightest.max(at(1.0, eta, k));
            }
            lines.push(CurveLine { weight, eta, k, mean });
        }
        let mut values = Box::new([Rgb::ZERO; Self::STEPS + 1]);
        for (i, value) in values.iter_mut().enumerate() {
            *value = sum(&lines, i as f64 / Self::STEPS as f64, 1.0);
        }
        let most = values.iter().fold(Rgb::ONE, |most, &value| most.at_least(value));
        // At grazing incidence the reflectance is 1 up to rounding.
        let factor = |most: f64| if most > 1.0 + 1e-6 { brightest / most } else { 1.0 };
        Self { values, lines, again: Rgb::new(factor(most[0]), factor(most[1]), factor(most[2])) }
    }

    /// Reflectance of unpolarized light at a `cosine` of incidence, 0 to 1, in vacuum.
    #[inline]
    pub fn reflectance(&self, cosine: f64) -> Rgb {
        let steps = cosine * Self::STEPS as f64;
        let before = (steps as usize).min(Self::STEPS - 1);
        let (a, b) = (self.values[before], self.values[before + 1]);
        a + (b - a) * (steps - before as f64)
    }

    /// Reflectance in a medium of index `outside`, summed over wavelengths.
    pub fn reflectance_in(&self, outside: f64, cosine: f64) -> Rgb {
        sum(&self.lines, cosine, outside)
    }

    /// RGB color of a function of each wavelength's average reflectance.
    pub fn seen(&self, of_mean: impl Fn(f64) -> f64) -> Rgb {
        self.lines.iter().map(|line| line.weight * of_mean(line.mean)).sum()
    }

    /// The same in a medium of index `outside`; averages are accurate to 1e-3.
    pub fn seen_in(&self, outside: f64, of_mean: impl Fn(f64) -> f64) -> Rgb {
        let relative = |x: f64| Rgb::splat(x / outside);
        let mean = |line: &CurveLine| fresnel::ConductorIndex::new(relative(line.eta), relative(line.k)).average()[0];
        self.lines.iter().map(|line| line.weight * of_mean(mean(line))).sum()
    }

    /// Factor on the reflectance for light that such a metal has reflected before. It is below 1 for a channel that
    /// exceeds 1. It limits the channel to the best reflected wavelength at normal incidence. The red of gold in gold
    /// is accurate to 3 % after two and after five reflections.
    #[inline]
    pub fn repeat_correction(&self) -> Rgb {
        self.again
    }
}

/// Prints the reflectance at normal incidence instead of the tables.
impl fmt::Debug for Curve {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Curve").field(&self.reflectance(1.0)).finish()
    }
}

/// Reflectance at one wavelength.
fn at(cosine: f64, eta: f64, k: f64) -> f64 {
    fresnel::conductor(cosine, Rgb::splat(eta), Rgb::splat(k))[0]
}

/// RGB reflectance in a medium of index `outside`.
fn sum(lines: &[CurveLine], cosine: f64, outside: f64) -> Rgb {
    let relative = 1.0 / outside;
    let of = |line: &CurveLine| line.weight * at(cosine, line.eta * relative, line.k * relative);
    lines.iter().map(of).sum()
}

/// ∫ 2 f(μ) μ dμ over cosines from 0 to 1, by Simpson's rule.
fn mean(f: impl Fn(f64) -> f64) -> f64 {
    const STEPS: u32 = 64;
    let mut sum = 0.0;
    for i in 0..=STEPS {
        let mu = f64::from(i) / f64::from(STEPS);
        let weight = if i == 0 || i == STEPS { 1.0 } else { 2.0 + 2.0 * f64::from(i % 2) };
        sum += weight * f(mu) * mu;
    }
    sum * 2.0 / (3.0 * f64::from(STEPS))
}

#[cfg(test)]
mod tests {
    use super::super::METALS;
    use super::*;
    use crate::conductors::metal;
    use crate::spectra::{daylight, matching, xyz_to_rgb};
    use glam::DVec3;

    /// Reference integral over all visible wavelengths, in steps of 0.1 nm, with Fresnel's equations in complex
    /// numbers.
    fn integral(cosine: f64, outside: f64, index: impl Fn(f64) -> (f64, f64)) -> Rgb {
        let (mut seen, mut white) = (DVec3::ZERO, 0.0);
        for i in 0..=4700 {
            let wavelength = 360.0 + 0.1 * f64::from(i);
            let (eta, k) = index(wavelength.min(830.0));
            let response = matching(wavelength) * daylight(wavelength);
            seen += response * textbook(cosine, eta / outside, k / outside);
            white += response.y;
        }
        xyz_to_rgb(seen / white)
    }

    /// Mean of |(cos θ − n cos θt) / (cos θ + n cos θt)|² and |(n cos θ − cos θt) / (n cos θ + cos θt)|², for
    /// n = η + ik.
    fn textbook(cosine: f64, eta: f64, k: f64) -> f64 {
        let times = |a: [f64; 2], b: [f64; 2]| [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]];
        let square = |a: [f64; 2]| a[0] * a[0] + a[1] * a[1];
        let n = [eta, k];
        let n2 = times(n, n);
        // n cos θt = √(n² − sin²θ), with positive imaginary part.
        let of = [n2[0] - 1.0 + cosine * cosine, n2[1]];
        let length = square(of).sqrt().sqrt();
        let half = of[1].atan2(of[0]) / 2.0;
        let root = [length * half.cos(), length * half.sin()];
        let s = square([cosine - root[0], -root[1]]) / square([cosine + root[0], root[1]]);
        let [up, down] = [-1.0, 1.0].map(|sign| [n2[0] * cosine + sign * root[0], n2[1] * cosine + sign * root[1]]);
        (s + square(up) / square(down)) / 2.0
    }

    #[test]
    fn curves_are_the_integrals_at_all_angles() {
        for metal in &METALS {
            for i in 0..=200 {
                // Denser towards grazing incidence.
                let cosine = (f64::from(i) / 200.0).powi(2);
                // Every tenth is compared with the finest integral, the others with one in steps of 1 nm.
                let truth = if i % 10 == 0 {
                    integral(cosine, 1.0, |wavelength| metal.index_at(wavelength))
                } else {
                    Response::new(Illuminant::Daylight, 1).seen(|wavelength| {
                        let (eta, k) = metal.index_at(wavelength);
                        textbook(cosine, eta, k)
                    })
                };
                let off = metal.curve().reflectance(cosine) / truth - Rgb::ONE;
                assert!(off.abs().max() < 1e-3, "{metal:?} {cosine} {truth} {off}");
            }
            assert!((metal.curve().reflectance(0.0) - Rgb::ONE).abs().max() < 1e-12);
        }
    }

    #[test]
    fn metals_have_the_colours_of_their_spectra() {
        // By numpy from the measurements of Mitsuba 3.9, with the CIE's tables at every nm. Where the measurements
        // differ, as for copper and tungsten, results agree within 0.4 %.
        for (symbol, truth, bound) in [
            ("Ag", [0.97146, 0.95990, 0.91539], 5e-4),
            ("Al", [0.91320, 0.92150, 0.92450], 5e-4),
            ("Au", [1.02190, 0.78240, 0.34340], 1e-3),
            ("Be", [0.53910, 0.53790, 0.53700], 5e-4),
            ("Cr", [0.63470, 0.66220, 0.70460], 5e-4),
            ("Cu", [0.95530, 0.63760, 0.53820], 4e-3),
            ("Ni", [0.65930, 0.60860, 0.52580], 5e-4),
            ("TiN", [0.61380, 0.46150, 0.23270], 1e-3),
            ("W", [0.51530, 0.49590, 0.46760], 2e-3),
        ] {
            let off = metal(symbol).unwrap().curve().reflectance(1.0) / Rgb::from_array(truth) - Rgb::ONE;
            assert!(off.abs().max() < bound, "{symbol} {off}");
        }
    }

    #[test]
    fn under_water_it_is_the_integral_for_the_relative_index() {
        for symbol in ["Au", "Al", "K"] {
            let metal = metal(symbol).unwrap();
            for cosine in [0.0, 0.05, 0.4, 1.0] {
                let truth = integral(cosine, 1.33, |wavelength| metal.index_at(wavelength));
                let off = metal.curve().reflectance_in(1.33, cosine) / truth - Rgb::ONE;
                assert!(off.abs().max() < 1e-3, "{metal:?} {cosine} {off}");
            }
        }
    }

    #[test]
    fn what_is_the_same_at_all_wavelengths_is_grey() {
        let grey = Curve::new(|_| (0.2, 3.9));
        for cosine in [0.0, 0.003, 0.5, 1.0] {
            let truth = Rgb::splat(textbook(cosine, 0.2, 3.9));
            assert!((grey.reflectance(cosine) - truth).abs().max() < 1e-4, "{cosine}");
        }
        let mean = fresnel::ConductorIndex::new(Rgb::splat(0.2), Rgb::splat(3.9)).average();
        assert!((grey.seen(|mean| mean) - mean).abs().max() < 1e-3);
        assert_eq!(grey.repeat_correction(), Rgb::ONE);
    }

    #[test]
    fn means_are_those_of_the_curves() {
        for metal in &METALS {
            let curve = metal.curve();
            let cosines = (0..2000).map(|i| (f64::from(i) + 0.5) / 2000.0);
            let mean: Rgb = cosines.map(|mu| curve.reflectance(mu) * mu / 1000.0).sum();
            assert!((mean - curve.seen(|mean| mean)).abs().max() < 2e-4, "{metal:?}");
        }
    }

    #[test]
    fn no_gain_is_without_end() {
        for metal in &METALS {
            let curve = metal.curve();
            let once = |mu: f64| curve.reflectance(mu);
            let most = (0..=100).map(|i| once(f64::from(i) / 100.0)).fold(Rgb::ZERO, Rgb::at_least);
            assert!((most * curve.repeat_correction()).max() <= 1.0 + 1e-12 && most.max() < 1.03, "{metal:?}");
            // The darkest is carbon, which is not a metal.
            assert!((0..=100).all(|i| once(f64::from(i) / 100.0).min() > 0.1), "{metal:?}");
            // Only gold's red is outside the gamut.
            assert_eq!(curve.repeat_correction() == Rgb::ONE, metal.symbol != "Au", "{metal:?}");
            // The sum of all interreflections between facets equals the geometric series per wavelength.
            for lost in [0.1, 0.5, 0.999] {
                let all = curve.seen(|mean| (1.0 - lost) / (1.0 - lost * mean));
                let series: Rgb = (0..4_000).map(|n| curve.seen(|mean| (1.0 - lost) * (lost * mean).powi(n))).sum();
                assert!((all - series).abs().max() < 1e-9 && all.max() < 1.0225, "{metal:?}");
            }
        }
    }

    #[test]
    fn gold_in_gold_is_about_as_by_wavelength() {
        let gold = metal("Au").unwrap();
        for (cosine, reflections, bound) in [(1.0, 2, 0.03), (0.5, 2, 0.03), (1.0, 5, 0.03), (0.5, 5, 0.03)] {
            let truth = Response::new(Illuminant::Daylight, 1).seen(|wavelength| {
                let (eta, k) = gold.index_at(wavelength);
                textbook(cosine, eta, k).powi(reflections)
            });
            let once = gold.curve().reflectance(cosine)[0];
            let red = once * (once * gold.curve().repeat_correction()[0]).powi(reflections - 1);
            assert!((red / truth[0] - 1.0).abs() < bound, "{reflections} {red} {truth}");
        }
    }
}
