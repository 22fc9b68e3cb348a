//! Paths that start at lights: how they go (`walk`), how surfaces scatter along the way of light (`adjoint`), and who
//! asks where they come to, cameras (`to_camera`) or those who want to see (`photons`).

mod adjoint;
mod dimensions;
mod photons;
mod to_camera;
mod walk;

pub use photons::{Photon, Photons, photons};
pub(super) use to_camera::LightPaths;
pub(super) use walk::Limits;
