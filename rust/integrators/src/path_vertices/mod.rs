//! Vertices of light paths and of bidirectional camera paths (`vertex`), and the scattering of flux there (`adjoint`).

mod adjoint;
mod vertex;

pub(super) use adjoint::{Arrived, Onward};
pub(super) use vertex::{ConnectedVertex, Point, Vertex};
