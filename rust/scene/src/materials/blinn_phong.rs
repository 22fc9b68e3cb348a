//! The Blinn-Phong material.

use super::phong::{parts, shares};
use super::{BsdfMix, Material};
use crate::ShadingPoint;
use crate::textures::{Needs, TexturePoint, Value};
use raywright_optics::{AnyBsdf, BlinnPhong, Rgb};

/// A diffuse surface with highlights around the half vector of light and view, on both sides.
#[derive(Clone, Debug)]
pub struct BlinnPhongMaterial {
    /// Diffuse reflectance, 0 to 1 in each channel.
    pub diffuse: Value,
    /// Specular reflectance, 0 to 1; the sum with the diffuse one is at most 1.
    pub specular: Value,
    /// Exponent of the cosine, not negative.
    pub exponent: Value<f64>,
    /// Ambient reflectance, for integrators with ambient light.
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
