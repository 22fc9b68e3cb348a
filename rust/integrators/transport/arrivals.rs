//! Paths that have come to surfaces.

use super::nesting::MediumStack;
use crate::math::Ray;

/// The paths of a queue that have come to surfaces, by how these scatter.
#[derive(Default)]
pub(super) struct Arrivals {
    /// By one diffuse colour.
    pub diffuse: Vec<u32>,
    /// Otherwise.
    pub others: Vec<u32>,
    /// The parts of rays around hits of what encloses a medium, and which paths' they are.
    pub windows: Vec<Ray>,
    pub of: Vec<u32>,
    /// In a scene of nested media, for each path of the queue the index of refraction on the other side of what the
    /// surface encloses, and what a ray that goes through is in.
    pub boundaries: Vec<(f64, MediumStack)>,
}
