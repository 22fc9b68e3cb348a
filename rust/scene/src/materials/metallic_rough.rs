//! The metallic-roughness material of glTF.

use super::checks::within;
use super::{BsdfMix, Material};
use crate::ShadingPoint;
use crate::textures::{Needs, TexturePoint, Value};
use raywright_optics::{AnyBsdf, MetallicRough};

/// The metallic-roughness model of glTF 2.0: from plastic to metal, in three parameters. Both sides reflect.
#[derive(Clone, Debug)]
pub struct MetallicRoughMaterial {
    /// Base color, 0 to 1 in each channel: diffuse albedo, or reflectance of the metal.
    pub base_colour: Value,
    /// From 0, dielectric, to 1, metal.
    pub metallic: Value<f64>,
    /// From 0 to 1; the facets' α is its square.
    pub roughness: Value<f64>,
}

impl MetallicRoughMaterial {
    fn bsdf(&self, point: &TexturePoint, outside: f64) -> AnyBsdf {
        let [metallic, roughness] = [self.metallic.at(point), self.roughness.at(point)];
        MetallicRough::within(self.base_colour.at(point), metallic, roughness, outside).into()
    }
}

impl Material for MetallicRoughMaterial {
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
        self.base_colour.needs() | self.metallic.needs() | self.roughness.needs()
    }

    fn minds_outside(&self) -> bool {
        true
    }

    fn validate(&self) -> Result<(), String> {
        within("base_color", &self.base_colour, 0.0, 1.0)?;
        within("metallic", &self.metallic, 0.0, 1.0)?;
        within("roughness", &self.roughness, 0.0, 1.0)
    }
}
