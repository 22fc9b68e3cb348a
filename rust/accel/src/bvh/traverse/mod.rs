//! Textbook traversals of binary BVHs, with single rays or packets.

mod bundle;
mod leaf_merging;
mod motion_blur;
mod node_volumes;
mod numbered_leaves;
mod occlusion;
mod ordered;
mod oriented;
mod packets;
mod ray_columns;
mod slabs;
mod threaded;

pub(super) use motion_blur::Moving;
pub(crate) use numbered_leaves::Numbered;
pub(crate) use occlusion::larger_first;
use ordered::Ordered;
pub use ordered::PacketSize;
pub use threaded::{Orders, Threaded};

use super::split_geometry::Contents;
use super::{BinaryBvh, Options};
use crate::walk::{Built, Input};
use leaf_merging::{Costs, gather};
use oriented::Oriented;
use raywright_base::math::Aabb;
use slabs::Slabs;

/// Triangles per SIMD test that leaves are optimized for, available at any level.
const BLOCK: usize = 4;

/// A traversal algorithm for binary BVHs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Traversal {
    /// With a stack.
    Stack(PacketSize),
    /// With a stack and single rays, and oriented boxes at the nodes.
    Oriented,
    /// The same with slabs along diagonals.
    Slabs,
    /// Without a stack.
    Threaded(Orders),
}

impl Traversal {
    /// All algorithms.
    pub const ALL: [Self; 7] = [
        Self::Stack(PacketSize::One),
        Self::Stack(PacketSize::Four),
        Self::Stack(PacketSize::SixtyFour),
        Self::Oriented,
        Self::Slabs,
        Self::Threaded(Orders::Six),
        Self::Threaded(Orders::Eight),
    ];

    /// Create a structure with this traversal; `kind` describes the build.
    pub fn over(self, bvh: BinaryBvh, input: &Input, kind: &str) -> Built {
        match self {
            Self::Stack(rays) => Ordered::over(bvh, rays, kind),
            Self::Oriented => Ordered::<Oriented>::within(bvh, input, kind),
            Self::Slabs => Ordered::<Slabs>::within(bvh, input, kind),
            Self::Threaded(orders) => Threaded::over(bvh, orders, kind),
        }
    }

    /// Build a tree with the given options and leaves for this traversal.
    pub fn build(self, input: &Input, options: &Options) -> Built {
        let (bvh, name) = gathered(input, options, BLOCK);
        self.over(bvh, input, &name)
    }
}

/// Build a tree for direct traversal, with leaves for `block` triangles per SIMD test; describe the build, too.
pub(crate) fn gathered(input: &Input, options: &Options, block: usize) -> (BinaryBvh, String) {
    // Other primitives are tested one by one.
    let block = if input.primitives.objects().is_some() { 1 } else { block };
    let steps = options.steps(block);
    let built = steps.build(&input.boxes, contents(input), input.work);
    let (bvh, name) = built.unwrap_or_default();
    let (traversal, intersection) = (options.traversal_cost, options.intersection_cost);
    (gather(&bvh, Costs { traversal, intersection, block }), name)
}

/// The geometry of the primitives for builders.
fn contents<'a>(input: &'a Input) -> Contents<'a> {
    Contents { primitives: input.primitives, region: &input.region, axes: None, boxes: &input.boxes }
}

/// The cost by the surface area heuristic, in tests of a node: two box tests per inner node, plus the primitives of
/// each leaf, each times the probability that a ray through the root's box hits the node's.
fn sah_cost(bvh: &BinaryBvh) -> f64 {
    let area = |aabb: &Aabb| f64::from(aabb.half_area());
    let sum: f64 = bvh.nodes.iter().map(|n| area(&n.aabb()) * if n.is_leaf() { f64::from(n.count) } else { 2.0 }).sum();
    match area(&bvh.bounds()) {
        root if root > 0.0 => sum / root,
        _ => bvh.nodes.len() as f64,
    }
}
