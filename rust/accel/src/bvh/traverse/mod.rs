//! Ways through the binary tree, as textbooks have them: one ray after the other, or some together.

mod any;
mod bundle;
mod columns;
mod gather;
mod moving;
mod numbered;
mod ordered;
mod oriented;
mod packets;
mod slabs;
mod threaded;
mod volumes;

pub(crate) use any::larger_first;
pub(super) use moving::Moving;
pub(crate) use numbered::Numbered;
use ordered::Ordered;
pub use ordered::Rays;
pub use threaded::{Orders, Threaded};

use super::contents::Contents;
use super::{BinaryBvh, Options};
use crate::walk::{Built, Input};
use gather::{Costs, gather};
use oriented::Oriented;
use raywright_base::math::Aabb;
use slabs::Slabs;

/// Triangles that leaves are made for, which are tested at once at any level.
const BLOCK: usize = 4;

/// A way through a binary tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Traversal {
    /// With a stack.
    Stack(Rays),
    /// With a stack, each ray alone, where nodes have turned boxes too.
    Oriented,
    /// The same with slabs along diagonals.
    Slabs,
    /// Without a stack.
    Threaded(Orders),
}

impl Traversal {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Stack(Rays::One),
        Self::Stack(Rays::Four),
        Self::Stack(Rays::SixtyFour),
        Self::Oriented,
        Self::Slabs,
        Self::Threaded(Orders::Six),
        Self::Threaded(Orders::Eight),
    ];

    /// A structure that is walked so; `kind` says how the tree was built.
    pub fn over(self, bvh: BinaryBvh, input: &Input, kind: &str) -> Built {
        match self {
            Self::Stack(rays) => Ordered::over(bvh, rays, kind),
            Self::Oriented => Ordered::<Oriented>::within(bvh, input, kind),
            Self::Slabs => Ordered::<Slabs>::within(bvh, input, kind),
            Self::Threaded(orders) => Threaded::over(bvh, orders, kind),
        }
    }

    /// Builds a tree as the options say, with leaves that suit one that is walked as it is.
    pub fn build(self, input: &Input, options: &Options) -> Built {
        let (bvh, name) = gathered(input, options, BLOCK);
        self.over(bvh, input, &name)
    }
}

/// A tree as the options say, with leaves that suit one that is walked as it is and tests so many triangles at once;
/// and how it was built.
pub(crate) fn gathered(input: &Input, options: &Options, block: usize) -> (BinaryBvh, String) {
    // What is no triangle is tested one by one.
    let block = if input.primitives.objects().is_some() { 1 } else { block };
    let steps = options.steps(block);
    let built = steps.build(&input.boxes, contents(input), input.work);
    let (bvh, name) = built.unwrap_or_default();
    let (traversal, intersection) = (options.traversal_cost, options.intersection_cost);
    (gather(&bvh, Costs { traversal, intersection, block }), name)
}

/// What builders see of primitives.
fn contents<'a>(input: &'a Input) -> Contents<'a> {
    Contents { primitives: input.primitives, region: &input.region, axes: None, boxes: &input.boxes }
}

/// The surface-area heuristic's cost of a tree, in tests of a node: of every inner node its two boxes, of every leaf
/// its primitives, each times the chance that a ray that meets the root's box meets this one's.
fn sah_cost(bvh: &BinaryBvh) -> f64 {
    let area = |aabb: &Aabb| f64::from(aabb.half_area());
    let sum: f64 = bvh.nodes.iter().map(|n| area(&n.aabb()) * if n.is_leaf() { f64::from(n.count) } else { 2.0 }).sum();
    match area(&bvh.bounds()) {
        root if root > 0.0 => sum / root,
        _ => bvh.nodes.len() as f64,
    }
}
