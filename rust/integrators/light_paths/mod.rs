//! Paths that start at lights: how they go (`walk`), how surfaces scatter along the way of light (`adjoint`), and who
//! asks where they come to, cameras (`to_camera`) or those who want to see (`photons`). Maps of what comes to surfaces
//! are a room of their own, `photon_map`.

mod adjoint;
mod dimensions;
mod photons;
mod to_camera;
mod walk;

pub(super) use adjoint::Arrived;
pub(super) use dimensions::Dimensions;
pub use photons::{Photon, Photons, photons};
pub(super) use to_camera::LightPaths;
pub(super) use walk::{Flying, LightWalk, Limits, Visitor};
