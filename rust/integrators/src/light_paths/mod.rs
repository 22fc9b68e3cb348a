//! Paths that start at lights: what they are aimed at (`targets`), how they go (`walk`), how surfaces scatter along the
//! way of light (`adjoint`), and where cameras see them (`to_camera`). What light finds may be weighed beside what is
//! found in other ways (`weights`, `partials`). Maps of what comes to surfaces are a room of their own, `photon_map`.

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
