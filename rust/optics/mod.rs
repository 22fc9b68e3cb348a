//! Floor 1: how much light there is, and how a surface scatters it.

mod bsdf;
mod diffuse;
mod spectrum;

pub use bsdf::{Bsdf, BsdfSample};
pub use diffuse::Diffuse;
pub use spectrum::{Rgb, is_radiance, luminance};
