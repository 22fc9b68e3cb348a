//! A soap bubble's skin.

use super::checks::{number, within};
use super::{BsdfMix, Material};
use crate::ShadingPoint;
use crate::textures::{Needs, TexturePoint, Value};
use raywright_optics::{AnyBsdf, SoapFilm};

/// A film with the same medium on both sides, of the colours of its thickness: the skin of a soap bubble. It encloses
/// nothing.
#[derive(Clone, Debug)]
pub struct SoapFilmMaterial {
    /// How thick it is, in nm.
    pub thickness: Value<f64>,
    /// The index of refraction within.
    pub ior: f64,
    /// Whether paths carry wavelengths.
    pub by_wave: bool,
}

impl SoapFilmMaterial {
    fn bsdf(&self, point: &TexturePoint, outside: f64) -> AnyBsdf {
        SoapFilm::new(self.thickness.at(point).max(0.0), self.ior, outside, point.waves).into()
    }
}

impl Material for SoapFilmMaterial {
    fn bsdf(&self, at: &ShadingPoint) -> BsdfMix {
        self.bsdf(&at.texture, at.outside).into()
    }

    fn constant(&self) -> Option<AnyBsdf> {
        (!self.needs().any()).then(|| self.bsdf(&TexturePoint::default(), 1.0))
    }

    fn kinds(&self) -> Option<[usize; 2]> {
        Some([self.bsdf(&TexturePoint::default(), 1.0).kind(); 2])
    }

    fn needs(&self) -> Needs {
        Needs { waves: self.by_wave, ..Needs::NONE } | self.thickness.needs()
    }

    fn validate(&self) -> Result<(), String> {
        within("thickness", &self.thickness, 0.0, f64::MAX)?;
        number("ior", self.ior, f64::MIN_POSITIVE, f64::MAX)
    }

    fn minds_outside(&self) -> bool {
        true
    }

    fn transmits(&self) -> bool {
        true
    }
}
