//! Emission aimed at specular objects (`aimed_emission`) and connections of light paths to the camera (`to_camera`).
//! MIS weights combine them with other strategies (`mis_weights`, `light_ends`). The paths themselves are in
//! `wavefront`, and photon maps in `photon_map`.

mod aimed_emission;
mod light_ends;
mod mis_weights;
mod to_camera;

pub(super) use aimed_emission::emitters;
pub(super) use light_ends::{LightEnd, LightEnds};
pub(super) use mis_weights::{Partial, of_asked, of_merged, weight};
pub(super) use to_camera::{Counting, LightPaths};
