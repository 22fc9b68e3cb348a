//! What conductors reflect.

use super::{Curve, FilmedMetal, Metal};
use crate::Rgb;
use crate::fresnel::ConductorIndex;
use crate::spectra::Waves;
use crate::thin_film::{self, Complex};

/// What a conductor reflects, by the cosine of incidence.
#[derive(Clone, Copy, Debug)]
pub enum Reflectance {
    /// By an index of refraction relative to the medium around it, channel by channel.
    Index(ConductorIndex),
    /// A measured metal's, by wavelength.
    Metal(&'static Curve),
    /// The same in a medium of an index of refraction.
    Within(&'static Curve, f64),
    /// By an index of refraction η + ik, channel by channel, under a film.
    Filmed {
        /// How thick the film is, in nm.
        thickness: f64,
        /// The indices of refraction of the medium around and of the film.
        layers: [f64; 2],
        /// That of the conductor.
        index: (Rgb, Rgb),
        /// The wavelengths that the channels stand for; none for red, green and blue.
        waves: Option<Waves>,
    },
    /// A measured metal's under a film, by wavelength.
    FilmedMetal(FilmedMetal),
}

impl Reflectance {
    /// Of a metal in a medium of index `outside`; 1 is vacuum.
    pub fn of(metal: &'static Metal, outside: f64) -> Self {
        if outside == 1.0 { Self::Metal(metal.curve()) } else { Self::Within(metal.curve(), outside) }
    }

    /// For unpolarised light of a `cosine` of incidence, 0 to 1.
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

    /// The share of even light from a hemisphere that is reflected.
    pub fn average(&self) -> Rgb {
        match self {
            Self::Index(index) => index.average(),
            Self::Filmed { .. } => average(|cosine| self.at(cosine)),
            Self::FilmedMetal(metal) => metal.average(),
            Self::Metal(_) | Self::Within(..) => self.seen(|mean| mean),
        }
    }

    /// What becomes of light by the mean reflectance for even light from a hemisphere: channel by channel, or of a
    /// bare metal by wavelength, seen together.
    pub fn seen(&self, of_mean: impl Fn(f64) -> f64) -> Rgb {
        match self {
            Self::Index(index) => index.average().map(of_mean),
            Self::Filmed { .. } | Self::FilmedMetal(_) => self.average().clamp(Rgb::ZERO, Rgb::ONE).map(of_mean),
            Self::Metal(curve) => curve.seen(of_mean),
            Self::Within(curve, outside) => curve.seen_in(*outside, of_mean),
        }
    }

    /// See [`Curve::again`].
    #[inline]
    pub fn again(&self) -> Rgb {
        match self {
            Self::Index(_) | Self::Filmed { .. } => Rgb::ONE,
            Self::FilmedMetal(metal) => metal.again(),
            Self::Metal(curve) | Self::Within(curve, _) => curve.again(),
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
