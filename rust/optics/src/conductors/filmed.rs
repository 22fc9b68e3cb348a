//! RGB reflectance of metals under a thin film.

use super::Metal;
use crate::Rgb;
use crate::spectra::{Illuminant, Response};
use crate::thin_film::{self, Complex, FARTHEST};
use std::collections::HashMap;
use std::fmt;
use std::sync::{LazyLock, PoisonError, RwLock};

/// RGB reflectance of a measured metal under a film of one thickness, in linear Rec. 709 under daylight, like
/// [`super::Curve`] for bare metals: Airy's sum at each wavelength, integrated. Negative channels are clamped to 0; a
/// channel may exceed 1.
pub struct FilmedCurve {
    /// At cosines of incidence that are squares of equally spaced numbers from 0 to 1.
    values: Vec<Rgb>,
    mean: Rgb,
    again: Rgb,
}

/// A metal, and the bits of its film's index, the surrounding index and the thickness.
type FilmKey = (&'static str, [u64; 3]);

/// Cache of all curves computed so far. They are few and never freed, because BSDFs refer to them.
static KNOWN: LazyLock<RwLock<HashMap<FilmKey, &'static FilmedCurve>>> = LazyLock::new(RwLock::default);

impl FilmedCurve {
    /// With this number of steps, cubic interpolation is within 5e-5 of the integral.
    const STEPS: usize = 96;

    /// The curve of a film with this thickness in nm and index, in a medium of index `outside`; computed on first use.
    pub fn of(metal: &'static Metal, thickness: f64, film: f64, outside: f64) -> &'static Self {
        // For thicker films fringes are too dense to be visible, and the thickness no longer matters.
        let thickness = thickness.min(FARTHEST / (2.0 * film));
        let key = (metal.symbol, [film, outside, thickness].map(f64::to_bits));
        // A poisoned lock is safe: a panic cannot leave a partial entry.
        if let Some(known) = KNOWN.read().unwrap_or_else(PoisonError::into_inner).get(&key) {
            return known;
        }
        let made = Self::new(|nm| metal.index_at(nm), thickness, film, outside);
        let mut known = KNOWN.write().unwrap_or_else(PoisonError::into_inner);
        known.entry(key).or_insert_with(|| Box::leak(Box::new(made)))
    }

    fn new(index: impl Fn(f64) -> (f64, f64), thickness: f64, film: f64, outside: f64) -> Self {
        // Every nm, because fringes of a film on silver are that narrow near grazing incidence.
        let lines: Vec<_> = Response::new(Illuminant::Daylight, 1)
            .weights()
            .map(|(nm, weight)| {
                let (eta, k) = index(nm);
                (nm, weight, Complex::new(eta, k))
            })
            .collect();
        let at = |cosine: f64, (nm, _, base): (f64, Rgb, Complex)| {
            thin_film::reflectance(nm, cosine, thickness, outside, film, base)
        };
        let cosine = |i: usize| (i as f64 / Self::STEPS as f64).powi(2);
        let value = |i| lines.iter().map(|&line| line.1 * at(cosine(i), line)).sum::<Rgb>().at_least(Rgb::ZERO);
        let values: Vec<Rgb> = (0..=Self::STEPS).map(value).collect();
        let most = values.iter().fold(Rgb::ONE, |most, &value| most.at_least(value));
        // As for a bare metal: only one reflection may exceed 1.
        let seen = lines.iter().filter(|line| (400.0..=700.0).contains(&line.0));
        let brightest = seen.map(|&line| at(1.0, line)).fold(0.0, f64::max);
        let factor = |most: f64| if most > 1.0 + 1e-6 { brightest / most } else { 1.0 };
        // 2 μ dμ = 4 t³ dt for μ = t², by Simpson's rule.
        let mut mean = Rgb::ZERO;
        for (i, &value) in values.iter().enumerate() {
            let (t, is_last) = (i as f64 / Self::STEPS as f64, i == Self::STEPS);
            let weight = if is_last { 1.0 } else { 2.0 + 2.0 * (i % 2) as f64 };
            mean += value * (4.0 * t.powi(3) * weight / (3.0 * Self::STEPS as f64));
        }
        Self { values, mean, again: most.map(factor) }
    }

    /// Interpolates the values about a square root of the cosine, in steps.
    #[inline]
    fn at(&self, before: usize, weights: &[f64; 4]) -> Rgb {
        let near = &self.values[before..before + 4];
        near[0] * weights[0] + near[1] * weights[1] + near[2] * weights[2] + near[3] * weights[3]
    }
}

/// Prints the reflectance at normal incidence instead of the tables.
impl fmt::Debug for FilmedCurve {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("FilmedCurve").field(&self.values[Self::STEPS]).finish()
    }
}

/// RGB reflectance of a measured metal at a point, for its film thickness there.
#[derive(Clone, Copy, Debug)]
pub enum FilmedMetal {
    /// A single curve.
    One(&'static FilmedCurve),
    /// Cubic interpolation between four equally spaced thicknesses, at this fraction of a step beyond the second.
    Between([&'static FilmedCurve; 4], f64),
}

impl FilmedMetal {
    /// Step in thickness, in nm, for a film of this index. Cubic interpolation between films at these steps is within
    /// 3e-4 of the integral up to 66 degrees, within 2e-3 up to 87, and within 5e-3 beyond, where fringes are narrow.
    pub fn step(film: f64) -> f64 {
        Self::WAY / (2.0 * film)
    }

    /// Optical path difference of a step.
    const WAY: f64 = 8.0;

    /// Number of steps at which fringes become too dense to be visible.
    pub const MOST: f64 = FARTHEST / Self::WAY;

    /// Reflectance of unpolarized light at a `cosine` of incidence, 0 to 1.
    pub fn reflectance(&self, cosine: f64) -> Rgb {
        let steps = cosine.clamp(0.0, 1.0).sqrt() * FilmedCurve::STEPS as f64;
        let before = (steps as usize).clamp(1, FilmedCurve::STEPS - 2) - 1;
        let weights = cubic(steps - (before + 1) as f64);
        let of = |curve: &FilmedCurve| curve.at(before, &weights);
        let value = match self {
            Self::One(curve) => of(curve),
            Self::Between(curves, t) => weighed(curves.map(of), &cubic(*t)),
        };
        value.at_least(Rgb::ZERO)
    }

    /// Cosine-weighted average of the reflectance.
    pub fn average(&self) -> Rgb {
        match self {
            Self::One(curve) => curve.mean,
            Self::Between(curves, t) => weighed(curves.map(|curve| curve.mean), &cubic(*t)),
        }
    }

    /// See [`super::Curve::repeat_correction`].
    pub fn repeat_correction(&self) -> Rgb {
        match self {
            Self::One(curve) => curve.again,
            Self::Between(curves, _) => curves.iter().fold(Rgb::ONE, |least, curve| least.at_most(curve.again)),
        }
    }
}

fn weighed(values: [Rgb; 4], weights: &[f64; 4]) -> Rgb {
    values[0] * weights[0] + values[1] * weights[1] + values[2] * weights[2] + values[3] * weights[3]
}

/// Weights of the values at −1, 0, 1 and 2 in the cubic through them.
#[inline]
fn cubic(t: f64) -> [f64; 4] {
    let (up, down, far) = (t + 1.0, 1.0 - t, 2.0 - t);
    [-down * far * t / 6.0, down * far * up * 0.5, t * up * far * 0.5, -t * up * down / 6.0]
}

#[cfg(test)]
mod tests {
    use super::super::{METALS, metal};
    use super::*;

    /// Integral over every nm.
    fn integral(metal: &Metal, thickness: f64, film: f64, cosine: f64) -> Rgb {
        Response::new(Illuminant::Daylight, 1).seen(|nm| {
            let (eta, k) = metal.index_at(nm);
            thin_film::reflectance(nm, cosine, thickness, 1.0, film, Complex::new(eta, k))
        })
    }

    #[test]
    fn filmed_metals_have_the_colour_of_the_integral() {
        for symbol in ["Au", "Ag", "W"] {
            let metal = metal(symbol).unwrap();
            for (film, thickness) in [(1.33, 120.0), (1.33, 900.0), (2.4, 60.0), (2.4, 2500.0)] {
                let filmed = FilmedMetal::One(FilmedCurve::of(metal, thickness, film, 1.0));
                for i in 1..=60 {
                    let cosine = (f64::from(i) / 60.0).powf(1.7);
                    let truth = integral(metal, thickness, film, cosine).at_least(Rgb::ZERO);
                    let off = (filmed.reflectance(cosine) - truth).abs().max();
                    assert!(off < 5e-5, "{symbol} {film} {thickness} {cosine} {off:e}");
                }
            }
        }
    }

    #[test]
    fn between_thicknesses_it_is_the_integral() {
        for symbol in ["Al", "Au"] {
            let metal = metal(symbol).unwrap();
            for (film, thickness) in [(1.33, 300.0), (2.0, 50.0), (2.6, 400.0)] {
                let step = FilmedMetal::step(film);
                let curves = [-1.0, 0.0, 1.0, 2.0].map(|k| FilmedCurve::of(metal, thickness + k * step, film, 1.0));
                let filmed = FilmedMetal::Between(curves, 0.5);
                for i in 1..=40 {
                    let cosine = (f64::from(i) / 40.0).powf(2.3);
                    let bound = [5e-3, 2e-3, 3e-4][usize::from(cosine > 0.05) + usize::from(cosine > 0.4)];
                    let truth = integral(metal, thickness + 0.5 * step, film, cosine).at_least(Rgb::ZERO);
                    let off = (filmed.reflectance(cosine) - truth).abs().max();
                    assert!(off < bound, "{symbol} {film} {cosine} {off:e}");
                }
            }
        }
    }

    #[test]
    fn without_a_thickness_it_is_the_bare_metal() {
        for metal in METALS.iter().step_by(5) {
            let filmed = FilmedMetal::One(FilmedCurve::of(metal, 0.0, 1.5, 1.0));
            for i in 0..=50 {
                let cosine = f64::from(i) / 50.0;
                let off = (filmed.reflectance(cosine) - metal.curve().reflectance(cosine)).abs().max();
                assert!(off < 3e-4, "{metal:?} {cosine} {off:e}");
            }
            assert!((filmed.average() - metal.curve().seen(|mean| mean)).abs().max() < 2e-4);
        }
    }

    #[test]
    fn no_gain_is_without_end() {
        for symbol in ["Au", "Cu", "Ag"] {
            for thickness in (0..20).map(|i| 40.0 * f64::from(i)) {
                let filmed = FilmedMetal::One(FilmedCurve::of(metal(symbol).unwrap(), thickness, 1.5, 1.0));
                for i in 0..=60 {
                    let once = filmed.reflectance(f64::from(i) / 60.0);
                    assert!(
                        (once * filmed.repeat_correction()).max() <= 1.0 + 1e-4 && once.min() >= 0.0,
                        "{symbol} {thickness}"
                    );
                }
            }
        }
    }
}
