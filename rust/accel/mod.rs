//! Floor 2: what finds hits.

mod brute;
pub mod bvh;
mod slab;

pub use brute::BruteForce;
pub use slab::SlabRay;

use crate::math::{Aabb, Hit, Ray, Vec3};

/// What an accelerator is built from: primitives known by their numbers, boxes and corners.
///
/// The accelerators know no scene; whoever owns primitives shows them so.
pub trait Primitives: Sync {
    /// The number of primitives; they are numbered from 0.
    fn count(&self) -> usize;
    /// The box around a primitive, empty if nothing can hit it.
    fn aabb(&self, primitive: u32) -> Aabb;
    /// The corners of a triangle.
    fn corners(&self, primitive: u32) -> [Vec3; 3];
}

/// Finds hits among primitives. Every accelerator gives the same answers, ties included: of equal `t`, the lowest
/// primitive.
pub trait Accelerator: Send + Sync {
    /// The closest hit of each ray.
    fn intersect(&self, rays: &[Ray], hits: &mut [Hit]);

    /// Whether each ray hits anything.
    fn occluded(&self, rays: &[Ray], occluded: &mut [bool]);

    /// What it looks like.
    fn info(&self) -> &Info;
}

/// What an accelerator looks like.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Info {
    /// What it is, and how it was built.
    pub kind: String,
    /// Primitives in it: those that can be hit.
    pub primitives: usize,
    /// Inner nodes.
    pub nodes: usize,
    /// Leaves.
    pub leaves: usize,
    /// The longest way from the root to a leaf; 0 where the root is a leaf.
    pub depth: usize,
    /// Memory held.
    pub bytes: usize,
    /// Wall-clock time of the build.
    pub build_seconds: f64,
    /// Expected cost of a random ray that meets the root's box, by the surface-area heuristic (Goldsmith and Salmon
    /// 1987), in tests of a node or of a block of triangles.
    pub sah_cost: f64,
}

/// The largest coordinate of any primitive.
fn extent(bounds: &Aabb) -> f64 {
    f64::from(bounds.largest_coordinate())
}
