//! The dielectric material.

use super::checks::number;
use super::{BsdfMix, FacetKind, Interior, Material, Roughness};
use crate::ShadingPoint;
use crate::media::Medium;
use crate::textures::{Needs, TexturePoint};
use raywright_optics::{AnyBsdf, Beckmann, Dielectric, Facets, Ggx, Once};
use std::sync::Arc;

/// The interface of a clear solid or liquid, smooth or rough, that reflects and refracts. Its normals point outwards.
#[derive(Clone, Debug)]
pub struct DielectricMaterial {
    /// The interior.
    pub interior: Interior,
    /// Isotropic roughness.
    pub roughness: Roughness,
    /// Participating medium inside; `None` if it is clear.
    pub medium: Option<Arc<dyn Medium>>,
}

impl DielectricMaterial {
    /// The BSDF at a point, in a medium of index `outside`.
    #[inline]
    pub(super) fn bare(&self, point: &TexturePoint, outside: f64) -> AnyBsdf {
        let ([alpha, _], eta) = (self.roughness.alpha(point), self.interior.ior_at(point.waves.as_ref()) / outside);
        match self.roughness.facets {
            FacetKind::Ggx => Dielectric::of(eta, Ggx::rough([alpha; 2])).into(),
            FacetKind::Beckmann => Dielectric::of(eta, Beckmann::rough([alpha; 2])).into(),
            FacetKind::GgxOnce => Dielectric::of(eta, Once::<Ggx>::rough([alpha; 2])).into(),
            FacetKind::BeckmannOnce => Dielectric::of(eta, Once::<Beckmann>::rough([alpha; 2])).into(),
        }
    }
}

impl Material for DielectricMaterial {
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
        let roughness = self.roughness.needs();
        Needs { waves: roughness.waves | self.interior.dispersion.is_any(), ..roughness }
    }

    fn validate(&self) -> Result<(), String> {
        number("ior", self.interior.ior, f64::MIN_POSITIVE, f64::MAX)?;
        self.roughness.validate_alike()
    }

    fn transmits(&self) -> bool {
        true
    }

    fn interior(&self) -> Option<Interior> {
        Some(self.interior)
    }

    fn is_clear(&self) -> bool {
        true
    }

    fn medium(&self) -> Option<&Arc<dyn Medium>> {
        self.medium.as_ref()
    }
}
