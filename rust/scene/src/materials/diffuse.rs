//! The diffuse material.

use super::checks::within;
use super::{BsdfMix, Material};
use crate::ShadingPoint;
use crate::textures::{Needs, Value};
use raywright_optics::{AnyBsdf, Diffuse, Rgb};

/// A Lambertian surface on both sides.
#[derive(Clone, Debug)]
pub struct DiffuseMaterial {
    /// Reflectance, 0 to 1 in each channel.
    pub reflectance: Value,
}

impl Default for DiffuseMaterial {
    /// 50 % gray.
    fn default() -> Self {
        Self { reflectance: Rgb::splat(0.5).into() }
    }
}

impl Material for DiffuseMaterial {
    #[inline]
    fn bsdf(&self, at: &ShadingPoint) -> BsdfMix {
        Diffuse { reflectance: self.reflectance.at(&at.texture) }.into()
    }

    fn constant(&self) -> Option<AnyBsdf> {
        match self.reflectance {
            Value::Constant(reflectance) => Some(Diffuse { reflectance }.into()),
            Value::Texture(_) => None,
        }
    }

    fn kinds(&self) -> Option<[usize; 2]> {
        Some([AnyBsdf::DIFFUSE; 2])
    }

    fn needs(&self) -> Needs {
        self.reflectance.needs()
    }

    fn validate(&self) -> Result<(), String> {
        within("reflectance", &self.reflectance, 0.0, 1.0)
    }
}
