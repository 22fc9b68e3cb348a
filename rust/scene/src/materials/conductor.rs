//! The conductor material.

use super::checks::within;
use super::{BsdfMix, FacetKind, Material, Roughness};
use crate::ShadingPoint;
use crate::textures::{Needs, TexturePoint, Value};
use raywright_base::math::DVec3;
use raywright_optics::conductors::{Metal, Reflectance};
use raywright_optics::fresnel::ConductorIndex;
use raywright_optics::{AnyBsdf, Beckmann, Conductor, Facets, Ggx, Once};

/// A metal, smooth or rough, possibly anisotropic (brushed). Both sides reflect.
#[derive(Clone, Debug)]
pub struct ConductorMaterial {
    /// Complex index of refraction.
    pub index: Index,
    /// Roughness.
    pub roughness: Roughness,
}

/// A complex index of refraction.
#[derive(Clone, Debug)]
pub enum Index {
    /// Constants for red, green and blue.
    Constants {
        /// Real part, above 0.
        eta: Value,
        /// Imaginary part, not negative.
        k: Value,
    },
    /// A measured spectrum; true if paths are spectral.
    Measured(&'static Metal, bool),
}

impl ConductorMaterial {
    /// The BSDF at a point, in a medium of index `outside`.
    #[inline]
    pub(super) fn bare(&self, point: &TexturePoint, outside: f64) -> AnyBsdf {
        let fresnel = match &self.index {
            Index::Constants { eta, k } => {
                Reflectance::Index(ConductorIndex::new(eta.at(point) / outside, k.at(point) / outside))
            }
            Index::Measured(metal, _) => match &point.waves {
                Some(waves) => {
                    let [eta, k] = [waves.lanes(|nm| metal.index_at(nm).0), waves.lanes(|nm| metal.index_at(nm).1)];
                    Reflectance::Index(ConductorIndex::new(eta / outside, k / outside))
                }
                None => Reflectance::of(metal, outside),
            },
        };
        self.reflecting(fresnel, point)
    }

    /// The BSDF at a point for given facet reflectance.
    #[inline]
    pub(super) fn reflecting(&self, fresnel: Reflectance, point: &TexturePoint) -> AnyBsdf {
        let alpha = self.roughness.alpha(point);
        match self.roughness.facets {
            FacetKind::Ggx => Conductor::of(fresnel, Ggx::rough(alpha)).into(),
            FacetKind::Beckmann => Conductor::of(fresnel, Beckmann::rough(alpha)).into(),
            FacetKind::GgxOnce => Conductor::of(fresnel, Once::<Ggx>::rough(alpha)).into(),
            FacetKind::BeckmannOnce => Conductor::of(fresnel, Once::<Beckmann>::rough(alpha)).into(),
        }
    }
}

impl Material for ConductorMaterial {
    fn bsdf(&self, at: &ShadingPoint) -> BsdfMix {
        self.bare(&at.texture, at.outside).into()
    }

    fn constant(&self) -> Option<AnyBsdf> {
        (!self.needs().any()).then(|| self.bare(&TexturePoint::default(), 1.0))
    }

    fn kinds(&self) -> Option<[usize; 2]> {
        Some([self.bare(&TexturePoint::default(), 1.0).kind(); 2])
    }

    fn needs(&self) -> Needs {
        let index = match &self.index {
            Index::Constants { eta, k } => eta.needs() | k.needs(),
            Index::Measured(_, by_wave) => Needs { waves: *by_wave, ..Needs::NONE },
        };
        index | self.roughness.needs()
    }

    fn validate(&self) -> Result<(), String> {
        if let Index::Constants { eta, k } = &self.index {
            within("eta", eta, f64::MIN_POSITIVE, f64::MAX)?;
            within("k", k, 0.0, f64::MAX)?;
        }
        self.roughness.validate()
    }

    fn minds_outside(&self) -> bool {
        true
    }

    fn tangent(&self, at: &ShadingPoint) -> Option<DVec3> {
        self.roughness.tangent(at)
    }
}
