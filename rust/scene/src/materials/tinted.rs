//! Tinted dielectrics.

use super::checks::within;
use super::{BsdfMix, DielectricMaterial, FacetKind, Interior, Material};
use crate::ShadingPoint;
use crate::media::Medium;
use crate::textures::{Needs, TexturePoint, Value};
use raywright_optics::{AnyBsdf, Beckmann, Bsdf, Dielectric, Facets, Ggx, Once, ThinDielectric, Tinted};
use std::sync::Arc;

/// Glass or a pane whose reflection and transmission are tinted at the surface: stained glass, a painted window.
#[derive(Clone, Debug)]
pub struct TintedMaterial {
    /// The material without tint.
    pub base: TintedBase,
    /// Factor on reflection, 0 to 1 in each channel.
    pub reflectance: Value,
    /// Factor on transmission at each crossing.
    pub transmittance: Value,
}

/// The base of a tint.
#[derive(Clone, Debug)]
pub enum TintedBase {
    /// A dielectric, on its outside.
    Dielectric(DielectricMaterial),
    /// A thin pane with this index of refraction and no interior.
    Pane(f64),
}

impl TintedMaterial {
    fn bsdf(&self, point: &TexturePoint, outside: f64) -> AnyBsdf {
        let glass = match &self.base {
            TintedBase::Pane(ior) => return self.tinted(point, ThinDielectric::new(ior / outside)).into(),
            TintedBase::Dielectric(glass) => glass,
        };
        let [alpha, _] = glass.roughness.alpha(point);
        let eta = glass.interior.ior_at(point.waves.as_ref()) / outside;
        match glass.roughness.facets {
            FacetKind::Ggx => self.tinted(point, Dielectric::of(eta, Ggx::rough([alpha; 2]))).into(),
            FacetKind::Beckmann => self.tinted(point, Dielectric::of(eta, Beckmann::rough([alpha; 2]))).into(),
            FacetKind::GgxOnce => self.tinted(point, Dielectric::of(eta, Once::<Ggx>::rough([alpha; 2]))).into(),
            FacetKind::BeckmannOnce => {
                self.tinted(point, Dielectric::of(eta, Once::<Beckmann>::rough([alpha; 2]))).into()
            }
        }
    }

    fn tinted<B: Bsdf>(&self, point: &TexturePoint, inner: B) -> Tinted<B> {
        Tinted { inner, reflectance: self.reflectance.at(point), transmittance: self.transmittance.at(point) }
    }

    fn glass(&self) -> Option<&DielectricMaterial> {
        if let TintedBase::Dielectric(glass) = &self.base { Some(glass) } else { None }
    }
}

impl Material for TintedMaterial {
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
        self.glass().map_or(Needs::NONE, Material::needs) | self.reflectance.needs() | self.transmittance.needs()
    }

    fn validate(&self) -> Result<(), String> {
        within("reflectance", &self.reflectance, 0.0, 1.0)?;
        within("transmittance", &self.transmittance, 0.0, 1.0)?;
        match &self.base {
            TintedBase::Dielectric(glass) => glass.validate(),
            TintedBase::Pane(ior) => super::checks::number("ior", *ior, f64::MIN_POSITIVE, f64::MAX),
        }
    }

    fn minds_outside(&self) -> bool {
        self.interior().is_none()
    }

    fn transmits(&self) -> bool {
        true
    }

    fn interior(&self) -> Option<Interior> {
        self.glass().and_then(Material::interior)
    }

    fn medium(&self) -> Option<&Arc<dyn Medium>> {
        self.glass().and_then(Material::medium)
    }
}
