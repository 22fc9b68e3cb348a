//! The principled materials.

use super::checks::{number, within};
use super::{BsdfMix, Interior, Material};
use crate::ShadingPoint;
use crate::textures::{Needs, TexturePoint, Value};
use raywright_base::math::DVec3;
use raywright_optics::{AnyBsdf, LayeredPrincipled, LayeredPrincipledThin, Look, Principled, PrincipledThin};

/// Parameters that both principled materials share, each 0 to 1; see [`Look`].
#[derive(Clone, Debug)]
pub struct LookTextures {
    /// Base color.
    pub base_color: Value,
    /// Roughness; the facets' α is its square.
    pub roughness: Value<f64>,
    /// Anisotropy of highlights.
    pub anisotropic: Value<f64>,
    /// Transmitted share.
    pub transmission: Value<f64>,
    /// Tint of highlights by the base color.
    pub specular_tint: Value<f64>,
    /// Sheen, at grazing angles.
    pub sheen: Value<f64>,
    /// Tint of the sheen by the base color.
    pub sheen_tint: Value<f64>,
    /// Share of the flat lobe that approximates subsurface scattering.
    pub flatness: Value<f64>,
    /// True if a white surface conserves energy exactly.
    pub conserves: bool,
}

impl LookTextures {
    fn numbers(&self) -> [(&str, &Value<f64>); 7] {
        [
            ("roughness", &self.roughness),
            ("anisotropic", &self.anisotropic),
            ("transmission", &self.transmission),
            ("specular_tint", &self.specular_tint),
            ("sheen", &self.sheen),
            ("sheen_tint", &self.sheen_tint),
            ("flatness", &self.flatness),
        ]
    }

    fn at(&self, point: &TexturePoint) -> Look {
        Look {
            base_color: self.base_color.at(point),
            luminance: self.base_color.at(&TexturePoint { waves: None, ..*point }).luminance(),
            roughness: self.roughness.at(point),
            anisotropic: self.anisotropic.at(point),
            transmission: self.transmission.at(point),
            specular_tint: self.specular_tint.at(point),
            sheen: self.sheen.at(point),
            sheen_tint: self.sheen_tint.at(point),
            flatness: self.flatness.at(point),
        }
    }

    fn needs(&self) -> Needs {
        let along = if self.is_alike() { Needs::NONE } else { Needs { uv: true, tangents: true, ..Needs::NONE } };
        self.numbers().into_iter().fold(self.base_color.needs() | along, |needs, (_, value)| needs | value.needs())
    }

    /// Returns whether highlights are isotropic.
    fn is_alike(&self) -> bool {
        self.anisotropic.range()[1] <= 0.0
    }

    /// The u direction, if highlights are anisotropic.
    fn tangent(&self, at: &ShadingPoint) -> Option<DVec3> {
        (!self.is_alike()).then_some(at.dp[0])
    }

    fn validate(&self) -> Result<(), String> {
        within("base_color", &self.base_color, 0.0, 1.0)?;
        self.numbers().into_iter().try_for_each(|(name, value)| within(name, value, 0.0, 1.0))
    }
}

/// The principled material: from plastic to metal to glass, under a clear coat.
#[derive(Clone, Debug)]
pub struct PrincipledMaterial {
    /// Shared parameters.
    pub looks: LookTextures,
    /// The interior.
    pub interior: Interior,
    /// From 0, dielectric, to 1, metal.
    pub metallic: Value<f64>,
    /// Weight of the clear coat, 0 to 1.
    pub clearcoat: Value<f64>,
    /// Gloss of the clear coat, 0 to 1.
    pub clearcoat_gloss: Value<f64>,
}

impl PrincipledMaterial {
    fn bsdf(&self, point: &TexturePoint, outside: f64) -> AnyBsdf {
        let solid = self.is_solid();
        // An opaque material reflects with the index of yellow light, and not at all if that of the surroundings is
        // greater.
        let eta = if solid {
            self.interior.ior_at(point.waves.as_ref()) / outside
        } else {
            self.interior.ior / outside.min(self.interior.ior.max(1.0))
        };
        // The coat has index 1.5; its reflectance is scaled by that at normal incidence in the surroundings.
        let coating = (5.0 * (1.5 - outside) / (1.5 + outside)).clamp(0.0, 1.0).powi(2);
        let coat = [self.clearcoat.at(point) * coating, self.clearcoat_gloss.at(point)];
        let (look, metallic) = (self.looks.at(point), self.metallic.at(point));
        if self.looks.conserves {
            LayeredPrincipled::new(look, eta, metallic, coat).into()
        } else {
            Principled::new(look, eta, metallic, coat, solid).into()
        }
    }

    /// Returns whether any light is transmitted.
    fn is_solid(&self) -> bool {
        self.looks.transmission.range()[1] > 0.0
    }
}

impl Material for PrincipledMaterial {
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
        let parts = Needs { waves: self.interior.dispersion.is_any(), ..Needs::NONE };
        self.looks.needs() | self.metallic.needs() | self.clearcoat.needs() | self.clearcoat_gloss.needs() | parts
    }

    fn validate(&self) -> Result<(), String> {
        self.looks.validate()?;
        number("ior", self.interior.ior, f64::MIN_POSITIVE, f64::MAX)?;
        within("metallic", &self.metallic, 0.0, 1.0)?;
        within("clearcoat", &self.clearcoat, 0.0, 1.0)?;
        within("clearcoat_gloss", &self.clearcoat_gloss, 0.0, 1.0)
    }

    fn minds_outside(&self) -> bool {
        !self.is_solid()
    }

    fn transmits(&self) -> bool {
        self.is_solid()
    }

    fn tangent(&self, at: &ShadingPoint) -> Option<DVec3> {
        self.looks.tangent(at)
    }

    fn interior(&self) -> Option<Interior> {
        self.is_solid().then_some(self.interior)
    }
}

/// The principled material of a thin sheet.
#[derive(Clone, Debug)]
pub struct PrincipledThinMaterial {
    /// Shared parameters.
    pub looks: LookTextures,
    /// Index of refraction.
    pub ior: f64,
    /// Share of diffuse light that is transmitted, 0 to 1.
    pub diffuse_transmission: Value<f64>,
}

impl PrincipledThinMaterial {
    fn bsdf(&self, point: &TexturePoint, outside: f64) -> AnyBsdf {
        let (look, across) = (self.looks.at(point), self.diffuse_transmission.at(point));
        let eta = self.ior / outside;
        if self.looks.conserves {
            LayeredPrincipledThin::new(look, eta, across).into()
        } else {
            PrincipledThin::new(look, eta, across).into()
        }
    }
}

impl Material for PrincipledThinMaterial {
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
        self.looks.needs() | self.diffuse_transmission.needs()
    }

    fn validate(&self) -> Result<(), String> {
        self.looks.validate()?;
        number("ior", self.ior, f64::MIN_POSITIVE, f64::MAX)?;
        within("diffuse_transmission", &self.diffuse_transmission, 0.0, 1.0)
    }

    fn minds_outside(&self) -> bool {
        true
    }

    fn transmits(&self) -> bool {
        true
    }

    fn tangent(&self, at: &ShadingPoint) -> Option<DVec3> {
        self.looks.tangent(at)
    }
}
