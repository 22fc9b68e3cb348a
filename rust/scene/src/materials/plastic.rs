//! The plastic material: a diffuse base under a clear coat.

use super::checks::{number, within};
use super::{BsdfMix, Coats, FacetKind, Material, Roughness};
use crate::ShadingPoint;
use crate::textures::{Needs, TexturePoint, Value};
use raywright_optics::{AnyBsdf, Beckmann, Coated, CoatedOnce, Facets, Ggx, Once, Rgb};
use std::sync::Arc;

/// A diffuse base under a clear coat, smooth or rough: plastic, glaze, varnish. Both sides are alike.
#[derive(Clone, Debug)]
pub struct PlasticMaterial {
    /// Albedo of the base, 0 to 1 in each channel.
    pub reflectance: Value,
    /// The coat's index of refraction, at least 1. If that of the surroundings is greater, the coat is invisible.
    pub ior: f64,
    /// Isotropic roughness of the coat.
    pub roughness: Roughness,
    /// Precomputed transmittance of a single-scattering coat; initially empty.
    pub coats: Arc<Coats>,
}

impl PlasticMaterial {
    #[inline]
    fn bsdf(&self, point: &TexturePoint, outside: f64) -> AnyBsdf {
        let ([alpha, _], eta) = (self.roughness.alpha(point), (self.ior / outside).max(1.0));
        let reflectance = self.reflectance.at(point);
        match self.roughness.facets {
            FacetKind::Ggx => Coated::new(reflectance, eta, alpha).into(),
            FacetKind::Beckmann => Coated::of(reflectance, eta, Beckmann::rough([alpha; 2])).into(),
            FacetKind::GgxOnce => self.once::<Ggx>(reflectance, eta, alpha),
            FacetKind::BeckmannOnce => self.once::<Beckmann>(reflectance, eta, alpha),
        }
    }

    /// The BSDF with a single-scattering coat, or a smooth coat without facets.
    fn once<F: Facets>(&self, reflectance: Rgb, eta: f64, alpha: f64) -> AnyBsdf
    where
        AnyBsdf: From<CoatedOnce<F>>,
    {
        let Some(facets) = Once::<F>::rough([alpha; 2]) else {
            return Coated::new(reflectance, eta, 0.0).into();
        };
        let through = self.coats.through::<F>(self.roughness.alpha_range(), alpha, eta);
        CoatedOnce::new(reflectance, eta, facets, through).into()
    }
}

impl Material for PlasticMaterial {
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
        self.reflectance.needs() | self.roughness.needs()
    }

    fn minds_outside(&self) -> bool {
        true
    }

    fn validate(&self) -> Result<(), String> {
        within("reflectance", &self.reflectance, 0.0, 1.0)?;
        number("ior", self.ior, 1.0, f64::MAX)?;
        self.roughness.validate_alike()
    }
}
