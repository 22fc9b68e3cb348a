//! What conductors reflect.

use super::{Curve, Metal};
use crate::optics::Rgb;
use crate::optics::fresnel::ConductorIndex;

/// What a conductor reflects, by the cosine of incidence.
#[derive(Clone, Copy, Debug)]
pub enum Reflectance {
    /// By an index of refraction relative to the medium around it, channel by channel.
    Index(ConductorIndex),
    /// A measured metal's, by wavelength.
    Metal(&'static Curve),
    /// The same in a medium of an index of refraction.
    Within(&'static Curve, f64),
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
        }
    }

    /// The share of even light from a hemisphere that is reflected.
    pub fn average(&self) -> Rgb {
        match self {
            Self::Index(index) => index.average(),
            Self::Metal(_) | Self::Within(..) => self.seen(|mean| mean),
        }
    }

    /// What becomes of light by the mean reflectance for even light from a hemisphere: channel by channel, or of a
    /// metal by wavelength, seen together.
    pub fn seen(&self, of_mean: impl Fn(f64) -> f64) -> Rgb {
        match self {
            Self::Index(index) => {
                let mean = index.average();
                Rgb::new(of_mean(mean[0]), of_mean(mean[1]), of_mean(mean[2]))
            }
            Self::Metal(curve) => curve.seen(of_mean),
            Self::Within(curve, outside) => curve.seen_in(*outside, of_mean),
        }
    }

    /// See [`Curve::again`].
    #[inline]
    pub fn again(&self) -> Rgb {
        match self {
            Self::Index(_) => Rgb::ONE,
            Self::Metal(curve) | Self::Within(curve, _) => curve.again(),
        }
    }
}
