//! Blinn's form of Phong's model.

use super::phong::{parts, shares};
use super::{BsdfMix, Material};
use crate::ShadingPoint;
use crate::textures::{Needs, TexturePoint, Value};
use raywright_optics::{AnyBsdf, BlinnPhong, Rgb};

/// A matt surface with highlights where the normal halves the way between light and viewer, on both sides.
#[derive(Clone, Debug)]
pub struct BlinnPhongMaterial {
    /// The share of light that is reflected diffusely, 0 to 1 in each channel.
    pub diffuse: Value,
    /// The share that makes highlights, 0 to 1; with the other at most 1.
    pub specular: Value,
    /// The power of the cosine, not negative.
    pub exponent: Value<f64>,
    /// The share of ambient light that is reflected, for integrators that know one.
    pub ambient: Value,
}

impl BlinnPhongMaterial {
    fn bsdf(&self, point: &TexturePoint) -> BlinnPhong {
        let (diffuse, specular) = parts(point, &self.diffuse, &self.specular);
        BlinnPhong::new(diffuse, specular, self.exponent.at(point))
    }
}

impl Material for BlinnPhongMaterial {
    fn bsdf(&self, at: &ShadingPoint) -> BsdfMix {
        self.bsdf(&at.texture).into()
    }

    fn constant(&self) -> Option<AnyBsdf> {
        (!self.needs().any()).then(|| self.bsdf(&TexturePoint::default()).into())
    }

    fn kinds(&self) -> Option<[usize; 2]> {
        Some([AnyBsdf::from(self.bsdf(&TexturePoint::default())).kind(); 2])
    }

    fn needs(&self) -> Needs {
        self.diffuse.needs() | self.specular.needs() | self.exponent.needs() | self.ambient.needs()
    }

    fn validate(&self) -> Result<(), String> {
        shares(&self.diffuse, &self.specular, &self.exponent, &self.ambient)
    }

    fn ambient(&self, at: &ShadingPoint) -> Rgb {
        self.ambient.at(&at.texture)
    }
}
