//! Metal.

use super::checks::within;
use super::{FacetKind, Material, Roughness, Scattering};
use crate::math::DVec3;
use crate::optics::fresnel::ConductorIndex;
use crate::optics::{Beckmann, Bsdf, Conductor, Facets, Ggx, Once};
use crate::scene::ShadingPoint;
use crate::scene::textures::{Needs, TexturePoint, Value};

/// A metal, smooth or rough, which may be brushed: rougher along one direction than across. Both sides reflect.
#[derive(Clone, Debug)]
pub struct ConductorMaterial {
    /// The real part of its index of refraction, above 0.
    pub eta: Value,
    /// The imaginary part, not negative.
    pub k: Value,
    /// How rough it is.
    pub roughness: Roughness,
}

impl ConductorMaterial {
    #[inline]
    fn bsdf(&self, point: &TexturePoint, outside: f64) -> Bsdf {
        let index = ConductorIndex::new(self.eta.at(point) / outside, self.k.at(point) / outside);
        let alpha = self.roughness.alpha(point);
        match self.roughness.facets {
            FacetKind::Ggx => Conductor::of(index, Ggx::rough(alpha)).into(),
            FacetKind::GgxOnce => Conductor::of(index, Once::<Ggx>::rough(alpha)).into(),
            FacetKind::BeckmannOnce => Conductor::of(index, Once::<Beckmann>::rough(alpha)).into(),
        }
    }
}

impl Material for ConductorMaterial {
    fn scattering(&self, at: &ShadingPoint) -> Scattering {
        self.bsdf(&at.texture, at.outside).into()
    }

    fn constant(&self) -> Option<Bsdf> {
        (!self.needs().any()).then(|| self.bsdf(&TexturePoint::default(), 1.0))
    }

    fn needs(&self) -> Needs {
        self.eta.needs() | self.k.needs() | self.roughness.needs()
    }

    fn validate(&self) -> Result<(), String> {
        within("eta", &self.eta, f64::MIN_POSITIVE, f64::MAX)?;
        within("k", &self.k, 0.0, f64::MAX)?;
        self.roughness.validate()
    }

    fn tangent(&self, at: &ShadingPoint) -> Option<DVec3> {
        self.roughness.tangent(at)
    }
}
