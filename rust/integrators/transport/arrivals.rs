//! Paths that have come to surfaces.

use crate::integrators::nesting::MediumStack;

/// The paths of a queue that have come to surfaces, by how these scatter.
#[derive(Default)]
pub(super) struct Arrivals {
    /// By one diffuse colour.
    pub diffuse: Vec<u32>,
    /// Otherwise.
    pub others: Vec<u32>,
    /// In a scene of nested media, for each path of the queue the index of refraction on the other side of what the
    /// surface encloses, and what a ray that goes through is in.
    pub boundaries: Vec<(f64, MediumStack)>,
}
