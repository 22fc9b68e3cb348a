//! The end of a medium that has no surface.

use super::{BsdfMix, Material};
use crate::ShadingPoint;
use crate::media::Medium;
use crate::textures::{Needs, TexturePoint};
use raywright_optics::{Rgb, Transparent};
use std::sync::Arc;

/// Where a medium ends, as smoke or a cloud does: light passes as if nothing were there. Its normals point out.
#[derive(Clone, Debug)]
pub struct BoundaryMaterial {
    /// What it encloses.
    pub medium: Arc<dyn Medium>,
    /// Where several overlap, the medium of the greatest priority is there.
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

    /// Whoever knows of no media goes through it as through a hole.
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
