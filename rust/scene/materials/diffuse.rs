//! A matt surface.

use super::checks::within;
use super::{Material, Scattering};
use crate::optics::{Bsdf, Diffuse, Rgb};
use crate::scene::ShadingPoint;
use crate::scene::textures::{Needs, Value};

/// Scatters by Lambert's law, on both sides.
#[derive(Clone, Debug)]
pub struct DiffuseMaterial {
    /// The share of the light that is reflected, 0 to 1 in each channel.
    pub reflectance: Value,
}

impl Default for DiffuseMaterial {
    /// Half grey.
    fn default() -> Self {
        Self { reflectance: Rgb::splat(0.5).into() }
    }
}

impl Material for DiffuseMaterial {
    #[inline]
    fn scattering(&self, at: &ShadingPoint) -> Scattering {
        Diffuse { reflectance: self.reflectance.at(&at.texture) }.into()
    }

    fn constant(&self) -> Option<Bsdf> {
        match self.reflectance {
            Value::Constant(reflectance) => Some(Diffuse { reflectance }.into()),
            Value::Texture(_) => None,
        }
    }

    fn needs(&self) -> Needs {
        self.reflectance.needs()
    }

    fn validate(&self) -> Result<(), String> {
        within("reflectance", &self.reflectance, 0.0, 1.0)
    }
}
