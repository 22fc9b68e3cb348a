//! Reflectance of conductors.

use super::{Curve, FilmedMetal, Metal};
use crate::Rgb;
use crate::fresnel::ConductorIndex;
use crate::spectra::Waves;
use crate::thin_film::{self, Complex};

/// Reflectance of a conductor as a function of the cosine of incidence.
#[derive(Clone, Copy, Debug)]
pub enum Reflectance {
    /// From a complex index of refraction relative to the surroundings, per channel.
    Index(ConductorIndex),
    /// Of a measured metal in vacuum, integrated over wavelengths.
    Metal(&'static Curve),
    /// Of a measured metal in a medium with this index of refraction.
    Within(&'static Curve, f64),
    /// From a complex index of refraction η + ik per channel, under a film.
    Filmed {
        /// Thickness of the film in nm.
        thickness: f64,
        /// Indices of refraction of the surroundings and the film.
        layers: [f64; 2],
        /// Index of refraction of the conductor.
        index: (Rgb, Rgb),
        /// Wavelengths of the channels; `None` for red, green and blue.
        waves: Option<Waves>,
    },
    /// Of a measured metal under a film, integrated over wavelengths.
    FilmedMetal(FilmedMetal),
}

impl Reflectance {
    /// Reflectance of a metal in a medium of index `outside`; 1 is vacuum.
    pub fn of(metal: &'static Metal, outside: f64) -> Self {
        if outside == 1.0 { Self::Metal(metal.curve()) } else { Self::Within(metal.curve(), outside) }
    }

    /// Reflectance of unpolarized light at a `cosine` of incidence, 0 to 1.
    #[inline]
    pub fn at(&self, cosine: f64) -> Rgb {
        match self {
            Self::Index(index) => index.reflectance(cosine),
            Self::Metal(curve) => curve.reflectance(cosine),
            Self::Within(curve, outside) => curve.reflectance_in(*outside, cosine),
            Self::Filmed { thickness, layers, index, waves: None } => {
                thin_film::on_conductor(*thickness, *layers, *index, cosine.min(1.0)).clamp(Rgb::ZERO, Rgb::ONE)
            }
            Self::Filmed { thickness, layers: [outside, film], index: (eta, k), waves: Some(waves) } => {
                let at = |lane: usize| {
                    let (nm, base) = (waves.all()[lane], Complex::new(eta[lane], k[lane]));
                    thin_film::reflectance(nm, cosine.min(1.0), *thickness, *outside, *film, base)
                };
                Rgb::new(at(0), at(1), at(2))
            }
            Self::FilmedMetal(metal) => metal.reflectance(cosine),
        }
    }

    /// Cosine-weighted average of the reflectance.
    pub fn average(&self) -> Rgb {
        match self {
            Self::Index(index) => index.average(),
            Self::Filmed { .. } => average(|cosine| self.at(cosine)),
            Self::FilmedMetal(metal) => metal.average(),
            Self::Metal(_) | Self::Within(..) => self.seen(|mean| mean),
        }
    }

    /// A function of the average reflectance: per channel or, for a bare metal, per wavelength and converted to RGB.
    pub fn seen(&self, of_mean: impl Fn(f64) -> f64) -> Rgb {
        match self {
            Self::Index(index) => index.average().map(of_mean),
            Self::Filmed { .. } | Self::FilmedMetal(_) => self.average().clamp(Rgb::ZERO, Rgb::ONE).map(of_mean),
            Self::Metal(curve) => curve.seen(of_mean),
            Self::Within(curve, outside) => curve.seen_in(*outside, of_mean),
        }
    }

    /// See [`Curve::repeat_correction`].
    #[inline]
    pub fn repeat_correction(&self) -> Rgb {
        match self {
            Self::Index(_) | Self::Filmed { .. } => Rgb::ONE,
            Self::FilmedMetal(metal) => metal.repeat_correction(),
            Self::Metal(curve) | Self::Within(curve, _) => curve.repeat_correction(),
        }
    }
}

/// ∫ 2 f(μ) μ dμ over cosines from 0 to 1, by Simpson's rule.
fn average(f: impl Fn(f64) -> Rgb) -> Rgb {
    const STEPS: u32 = 16;
    let mut sum = Rgb::ZERO;
    for i in 1..=STEPS {
        let mu = f64::from(i) / f64::from(STEPS);
        let weight = if i == STEPS { 1.0 } else { 2.0 + 2.0 * f64::from(i % 2) };
        sum += f(mu) * (weight * mu);
    }
    sum * (2.0 / (3.0 * f64::from(STEPS)))
}
