//! Light paths: aiming emission at specular objects (`targets`), tracing (`walk`), adjoint scattering (`adjoint`) and
//! connections to the camera (`to_camera`). MIS weights combine them with other strategies (`weights`, `partials`).
//! Photon maps are in `photon_map`.

mod adjoint;
mod dimensions;
mod partials;
mod targets;
mod to_camera;
mod walk;
mod weights;

pub(super) use adjoint::{Arrived, Onward, onward_pdf};
pub(super) use dimensions::{Dimensions, EmissionDimensions};
pub(super) use partials::{LightEnd, Partials};
pub(super) use targets::emitters;
pub(super) use to_camera::{LightPaths, Weighing};
pub(super) use walk::{Flying, LightWalk, Limits, Times, Visitor};
pub(super) use weights::{Partial, of_asked, of_merged, weight};
