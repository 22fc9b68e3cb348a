//! The film of a soap bubble.

use super::checks::{number, within};
use super::{BsdfMix, Material};
use crate::ShadingPoint;
use crate::textures::{Needs, TexturePoint, Value};
use raywright_optics::{AnyBsdf, SoapFilm};

/// A thin film with the same medium on both sides and interference colors: a soap bubble. It has no interior.
#[derive(Clone, Debug)]
pub struct SoapFilmMaterial {
    /// Thickness in nm.
    pub thickness: Value<f64>,
    /// Index of refraction of the film.
    pub ior: f64,
    /// True if paths are spectral.
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
