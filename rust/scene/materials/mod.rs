//! What surfaces are made of: one interface over all materials.

mod diffuse;
mod scattering;

pub use diffuse::DiffuseMaterial;
pub use scattering::Scattering;

use super::ShadingPoint;
use super::textures::{Needs, TexturePoint};
use crate::math::DVec3;
use crate::optics::Bsdf;
use std::fmt::Debug;

/// What a surface is made of: says how light is scattered at each of its points.
pub trait Material: Debug + Send + Sync {
    /// How it scatters at a point.
    fn scattering(&self, at: &ShadingPoint) -> Scattering;

    /// What it must know of a point.
    fn needs(&self) -> Needs;

    /// How it scatters, where that is the same at every point, on both sides and in every medium.
    fn constant(&self) -> Option<Bsdf> {
        None
    }

    /// What of it cannot be, in a few words; `Ok` if all can.
    fn validate(&self) -> Result<(), String>;

    /// The share of rays that meet it, 0 to 1: the others go on as if nothing were there.
    fn opacity(&self, _at: &TexturePoint) -> f64 {
        1.0
    }

    /// Whether all rays meet it everywhere.
    fn is_opaque(&self) -> bool {
        true
    }

    /// A shading normal of its own, unit and on the side of the point's, as bump and normal maps have it.
    fn normal(&self, _at: &ShadingPoint) -> Option<DVec3> {
        None
    }

    /// What fills what it encloses; none for what encloses nothing, as a sheet.
    fn interior(&self) -> Option<Interior> {
        None
    }
}

/// What fills a closed surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interior {
    /// Its index of refraction.
    pub ior: f64,
    /// Where several overlap, that of the greatest priority is there (Schmidt and Budge, "Simple Nested Dielectrics in Ray Traced
    /// Images", 2002).
    pub priority: i32,
}
