//! Alpha masks.

use super::checks::within;
use super::{BsdfMix, Interior, Material};
use crate::ShadingPoint;
use crate::media::Medium;
use crate::textures::{Needs, TexturePoint, Value};
use raywright_base::math::DVec3;
use raywright_optics::Rgb;
use std::sync::Arc;

/// A material with holes, such as leaves, lace or fences. Where the opacity is fractional, rays pass with the remaining
/// probability.
#[derive(Clone, Debug)]
pub struct Mask {
    /// The material of the opaque part.
    pub material: Arc<dyn Material>,
    /// Opacity: 0 in a hole, 1 elsewhere.
    pub opacity: Value<f64>,
}

impl Material for Mask {
    fn bsdf(&self, at: &ShadingPoint) -> BsdfMix {
        self.material.bsdf(at)
    }

    fn kinds(&self) -> Option<[usize; 2]> {
        self.material.kinds()
    }

    fn needs(&self) -> Needs {
        self.material.needs() | self.opacity.needs()
    }

    fn validate(&self) -> Result<(), String> {
        within("opacity", &self.opacity, 0.0, 1.0)?;
        self.material.validate()
    }

    fn opacity(&self, at: &TexturePoint) -> f64 {
        self.opacity.at(at).clamp(0.0, 1.0) * self.material.opacity(at)
    }

    fn mean_opacity(&self) -> f64 {
        // A texture's mean is approximate; the lower bound keeps a partly opaque mask from vanishing.
        let [_, most] = self.opacity.range();
        self.opacity.mean().clamp(1e-3 * most.clamp(0.0, 1.0), 1.0) * self.material.mean_opacity()
    }

    fn is_opaque(&self) -> bool {
        self.opacity.is_within(1.0, 1.0) && self.material.is_opaque()
    }

    fn minds_outside(&self) -> bool {
        self.material.minds_outside()
    }

    fn transmits(&self) -> bool {
        self.material.transmits()
    }

    fn normal(&self, at: &ShadingPoint) -> Option<DVec3> {
        self.material.normal(at)
    }

    fn tangent(&self, at: &ShadingPoint) -> Option<DVec3> {
        self.material.tangent(at)
    }

    fn interior(&self) -> Option<Interior> {
        self.material.interior()
    }

    fn medium(&self) -> Option<&Arc<dyn Medium>> {
        self.material.medium()
    }

    fn ambient(&self, at: &ShadingPoint) -> Rgb {
        self.material.ambient(at)
    }
}
