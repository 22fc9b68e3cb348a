//! Paths that have come to surfaces.

use crate::nesting::MediumStack;
use raywright_scene::Plan;

/// The paths of a queue that have come to surfaces, by how these scatter.
pub(super) struct Arrivals {
    /// A queue for each kind ([`Plan::kind`]), of which the first is diffuse.
    pub kinds: [Vec<u32>; Plan::KINDS],
    /// In a scene of nested media, for each path of the queue the index of refraction on the other side of what the
    /// surface encloses, and what a ray that goes through is in.
    pub boundaries: Vec<(f64, MediumStack)>,
}

impl Default for Arrivals {
    fn default() -> Self {
        Self { kinds: std::array::from_fn(|_| Vec::new()), boundaries: Vec::new() }
    }
}
