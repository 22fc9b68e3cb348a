//! The colour of a metal's reflection.

use crate::spectra::{Illuminant, Response};
use crate::{Rgb, fresnel};
use std::fmt;

/// How a conductor of an index of refraction that varies with the wavelength reflects daylight, in linear Rec. 709.
///
/// The reflectance is Fresnel's at each wavelength, and its colour that of daylight (D65) of such shares, where all of
/// it is (1, 1, 1). So light of (1, 1, 1) on gold becomes (1.022, 0.782, 0.344) at normal incidence, as spectral
/// renderers have it that take white for daylight. Under light that is even over wavelengths it would be (1.20, 0.75,
/// 0.31), of an even light of (1.20, 0.95, 0.91).
///
/// A channel may exceed 1, as gold's red does: the screen's three lights cannot mix that orange, and it is told as more
/// red than there is and less green. That is right for light that is reflected once. Its powers are not: they would
/// grow without end in a closed box, though gold leaves at most 96.2 % of a wavelength from 400 to 700 nm each time. So
/// what is scattered again and again within one rough surface is summed by wavelength ([`Curve::seen`]), and paths that
/// come to such a metal from such a metal give back by [`Curve::again`] what they had gained.
pub struct Curve {
    /// At cosines of incidence from 0 to 1, in even steps.
    values: Box<[Rgb; Self::STEPS + 1]>,
    lines: Vec<Line>,
    again: Rgb,
}

/// One wavelength for all near it.
#[derive(Clone, Copy, Debug)]
struct Line {
    weight: Rgb,
    eta: f64,
    k: f64,
    /// Its mean reflectance for even light from a hemisphere.
    mean: f64,
}

impl Curve {
    /// Lines between so many steps of the cosine are within 0.03 % of the reflectance.
    const STEPS: usize = 256;

    /// So many nm apart, wavelengths stand for all: gold, whose reflectance has the sharpest edge, errs by 0.05 %.
    const APART: u32 = 5;

    /// Of what tells η and k at each wavelength that is seen.
    pub fn new(index: impl Fn(f64) -> (f64, f64)) -> Self {
        let mut lines = Vec::new();
        let mut brightest: f64 = 0.0;
        for (wavelength, weight) in Response::new(Illuminant::Daylight, Self::APART).weights() {
            let (eta, k) = index(wavelength);
            let mean = mean(|cosine| at(cosine, eta, k));
            // Beyond, hardly anything is seen.
            if (400.0..=700.0).contains(&wavelength) {
                brightest = brightest.max(at(1.0, eta, k));
            }
            lines.push(Line { weight, eta, k, mean });
        }
        let mut values = Box::new([Rgb::ZERO; Self::STEPS + 1]);
        for (i, value) in values.iter_mut().enumerate() {
            *value = sum(&lines, i as f64 / Self::STEPS as f64, 1.0);
        }
        let most = values.iter().fold(Rgb::ONE, |most, &value| most.at_least(value));
        // What is 1 but for rounding, at grazing incidence, is 1.
        let factor = |most: f64| if most > 1.0 + 1e-6 { brightest / most } else { 1.0 };
        Self { values, lines, again: Rgb::new(factor(most[0]), factor(most[1]), factor(most[2])) }
    }

    /// The reflectance for unpolarised light of a `cosine` of incidence, 0 to 1, in vacuum.
    #[inline]
    pub fn reflectance(&self, cosine: f64) -> Rgb {
        let steps = cosine * Self::STEPS as f64;
        let before = (steps as usize).min(Self::STEPS - 1);
        let (a, b) = (self.values[before], self.values[before + 1]);
        a + (b - a) * (steps - before as f64)
    }

    /// The same in a medium of index `outside`, as the sum over wavelengths.
    pub fn reflectance_in(&self, outside: f64, cosine: f64) -> Rgb {
        sum(&self.lines, cosine, outside)
    }

    /// What becomes of light by the mean reflectance of each wavelength for even light from a hemisphere, seen
    /// together.
    pub fn seen(&self, of_mean: impl Fn(f64) -> f64) -> Rgb {
        self.lines.iter().map(|line| line.weight * of_mean(line.mean)).sum()
    }

    /// The same in a medium of index `outside`, by means that are right to 1e-3.
    pub fn seen_in(&self, outside: f64, of_mean: impl Fn(f64) -> f64) -> Rgb {
        let relative = |x: f64| Rgb::splat(x / outside);
        let mean = |line: &Line| fresnel::ConductorIndex::new(relative(line.eta), relative(line.k)).average()[0];
        self.lines.iter().map(|line| line.weight * of_mean(mean(line))).sum()
    }

    /// What the reflectance is to be multiplied by for light that such a metal has reflected before. It is less than 1
    /// in a channel that exceeds 1: then at most so much is left of that as of the wavelength that is reflected best,
    /// at normal incidence. So the red of gold in gold is right to 3 % after two and after five reflections.
    #[inline]
    pub fn again(&self) -> Rgb {
        self.again
    }
}

/// What white light becomes at normal incidence: tables are not for printing.
impl fmt::Debug for Curve {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Curve").field(&self.reflectance(1.0)).finish()
    }
}

/// The reflectance at one wavelength.
fn at(cosine: f64, eta: f64, k: f64) -> f64 {
    fresnel::conductor(cosine, Rgb::splat(eta), Rgb::splat(k))[0]
}

/// The colour of a reflectance, in a medium of index `outside`.
fn sum(lines: &[Line], cosine: f64, outside: f64) -> Rgb {
    let relative = 1.0 / outside;
    let of = |line: &Line| line.weight * at(cosine, line.eta * relative, line.k * relative);
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

    /// The integral over all that is seen, in steps of a tenth of a nm: Fresnel's equations in complex numbers, written
    /// out.
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

    /// |(cos θ − n cos θt) / (cos θ + n cos θt)|² and |(n cos θ − cos θt) / (n cos θ + cos θt)|², their mean, for n = η
    /// + ik.
    fn textbook(cosine: f64, eta: f64, k: f64) -> f64 {
        let times = |a: [f64; 2], b: [f64; 2]| [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]];
        let square = |a: [f64; 2]| a[0] * a[0] + a[1] * a[1];
        let n = [eta, k];
        let n2 = times(n, n);
        // n cos θt = √(n² − sin²θ), of a positive imaginary part.
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
        // By numpy from the measurements as Mitsuba 3.9 comes with them, with the CIE's tables at every nm. Where the
        // tables are not the same, as for copper and tungsten, they agree within 0.4 %.
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
        assert_eq!(grey.again(), Rgb::ONE);
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
            assert!((most * curve.again()).max() <= 1.0 + 1e-12 && most.max() < 1.03, "{metal:?}");
            // The darkest is carbon, which is no metal.
            assert!((0..=100).all(|i| once(f64::from(i) / 100.0).min() > 0.1), "{metal:?}");
            // Only gold's red is beyond the screen's.
            assert_eq!(curve.again() == Rgb::ONE, metal.symbol != "Au", "{metal:?}");
            // What facets throw on facets for ever is what each wavelength's series gives.
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
            let red = once * (once * gold.curve().again()[0]).powi(reflections - 1);
            assert!((red / truth[0] - 1.0).abs() < bound, "{reflections} {red} {truth}");
        }
    }
}
