//! A perfect mirror.

use super::checks::within;
use super::{BsdfMix, Material};
use crate::ShadingPoint;
use crate::textures::{Needs, TexturePoint, Value};
use raywright_optics::{AnyBsdf, Mirror};

/// Reflects specularly on both sides, with the same reflectance at all angles.
#[derive(Clone, Debug)]
pub struct MirrorMaterial {
    /// Reflectance, 0 to 1 in each channel.
    pub reflectance: Value,
}

impl MirrorMaterial {
    fn bsdf(&self, point: &TexturePoint) -> Mirror {
        Mirror { reflectance: self.reflectance.at(point) }
    }
}

impl Material for MirrorMaterial {
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
        self.reflectance.needs()
    }

    fn validate(&self) -> Result<(), String> {
        within("reflectance", &self.reflectance, 0.0, 1.0)
    }
}
