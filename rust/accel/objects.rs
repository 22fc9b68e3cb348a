//! Primitives that are no triangles: curved shapes, and whole scenes put elsewhere.

use super::query::Wanted;
use crate::math::Ray;
use crate::shapes::{Bounds, Candidate};

/// What is hit and is no triangle, known by its number among all primitives.
pub trait Objects: Send + Sync {
    /// The box around one, rounded outwards. None of what nothing can hit, triangles among it.
    fn bounds(&self, primitive: u32) -> Option<Bounds>;

    /// Calls `met` with what of it the ray meets between `t_min` and `t_max`, both ends included, until it says true; then that is said.
    /// Nothing has to be told but what is wanted: the first, or any, or every point.
    fn meet(&self, primitive: u32, wanted: Wanted, ray: &Ray, met: &mut dyn FnMut(Candidate) -> bool) -> bool;
}
