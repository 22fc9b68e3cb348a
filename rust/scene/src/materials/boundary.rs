//! The boundary of a medium without a surface.

use super::{BsdfMix, Material};
use crate::ShadingPoint;
use crate::media::Medium;
use crate::textures::{Needs, TexturePoint};
use raywright_optics::{Rgb, Transparent};
use std::sync::Arc;

/// A boundary of a medium such as smoke or a cloud; light passes through it unchanged. Its normals point outwards.
#[derive(Clone, Debug)]
pub struct BoundaryMaterial {
    /// The enclosed medium.
    pub medium: Arc<dyn Medium>,
    /// If several media overlap, the one with the greatest priority applies.
    pub priority: i32,
}

impl Material for BoundaryMaterial {
    fn bsdf(&self, _at: &ShadingPoint) -> BsdfMix {
        Transparent { transmittance: Rgb::ONE }.into()
    }

    fn needs(&self) -> Needs {
        Needs::NONE
    }

    fn validate(&self) -> Result<(), String> {
        Ok(())
    }

    /// Integrators without media pass through it as through a hole.
    fn opacity(&self, _at: &TexturePoint) -> f64 {
        0.0
    }

    fn is_opaque(&self) -> bool {
        false
    }

    fn transmits(&self) -> bool {
        true
    }

    fn medium(&self) -> Option<&Arc<dyn Medium>> {
        Some(&self.medium)
    }

    fn boundary(&self) -> Option<i32> {
        Some(self.priority)
    }

    fn is_passed(&self) -> bool {
        true
    }
}
