//! Light paths: aiming emission at specular objects (`targets`), tracing (`walk`), adjoint scattering (`adjoint`) and
//! connections to the camera (`to_camera`). MIS weights combine them with other strategies (`weights`, `partials`).
//! Photon maps are in `photon_map`.

mod adjoint;
mod aimed_emission;
mod dimensions;
mod light_walk;
mod mis_weights;
mod partials;
mod to_camera;

pub(super) use adjoint::{Arrived, Onward, onward_pdf};
pub(super) use aimed_emission::emitters;
pub(super) use dimensions::{Dimensions, EmissionDimensions};
pub(super) use light_walk::{Flying, LightWalk, Limits, Times, Visitor};
pub(super) use mis_weights::{Partial, of_asked, of_merged, weight};
pub(super) use partials::{LightEnd, Partials};
pub(super) use to_camera::{LightPaths, Weighing};
