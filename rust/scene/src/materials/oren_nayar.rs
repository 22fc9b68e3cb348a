//! The Oren-Nayar material.

use super::checks::within;
use super::{BsdfMix, Material};
use crate::ShadingPoint;
use crate::textures::{Needs, TexturePoint, Value};
use raywright_optics::{AnyBsdf, OrenNayar};

/// A rough diffuse surface of Lambertian facets, brighter towards the light: clay, plaster, the moon. Both sides
/// scatter.
#[derive(Clone, Debug)]
pub struct OrenNayarMaterial {
    /// Reflectance of a facet, 0 to 1 in each channel.
    pub reflectance: Value,
    /// From 0, Lambertian, to 1. It is not a microfacet α.
    pub roughness: Value<f64>,
}

impl OrenNayarMaterial {
    fn bsdf(&self, point: &TexturePoint) -> OrenNayar {
        OrenNayar::new(self.reflectance.at(point), self.roughness.at(point))
    }
}

impl Material for OrenNayarMaterial {
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
        self.reflectance.needs() | self.roughness.needs()
    }

    fn validate(&self) -> Result<(), String> {
        within("reflectance", &self.reflectance, 0.0, 1.0)?;
        within("roughness", &self.roughness, 0.0, 1.0)
    }
}
