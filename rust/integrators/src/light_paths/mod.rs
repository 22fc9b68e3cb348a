//! Paths from lights, among surfaces and media: aimed emission (`aimed_emission`), tracing (`light_walk`), adjoint
//! scattering (`adjoint`) and connections to the camera (`to_camera`). MIS weights combine them with other strategies
//! (`mis_weights`, `light_ends`). Photon maps are in `photon_map`.

mod adjoint;
mod aimed_emission;
mod dimensions;
mod light_ends;
mod light_walk;
mod mis_weights;
mod to_camera;
mod vertex;

pub(super) use adjoint::{Arrived, Onward};
pub(super) use aimed_emission::emitters;
pub(super) use dimensions::Dimensions;
pub(super) use light_ends::{LightEnd, LightEnds};
pub(super) use light_walk::{LightPath, LightWalk, Limits, Times, Visitor};
pub(super) use mis_weights::{Partial, of_asked, of_merged, weight};
pub(super) use to_camera::{Counting, LightPaths};
pub(super) use vertex::{Point, Vertex};
