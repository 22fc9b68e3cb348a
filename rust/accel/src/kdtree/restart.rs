//! No stack: after a leaf the ray goes down again from the top (Foley and Sugerman, "KD-Tree Acceleration Structures
//! for a GPU Raytracer", 2005), or from the lowest node that has all in it that is left (push-down; Horn, Sugerman,
//! Houston and Hanrahan, "Interactive k-D Tree GPU Raytracing", 2007).
//!
//! Where two leaves meet at a plane, it is not certain on which side of it a ray is, so that `t` alone would not say
//! where it has been. A bit a level does, of whether the ray is done with the side that it came to first
//! (Laine, "Restart Trail for Stackless BVH Traversal", 2010). So it comes to the same leaves as with a stack, in the
//! same order.

use super::planes::PlaneRay;
use super::{KdTree, MAX_DEPTH};
use crate::SlabRay;
use crate::walk::Walker;
use raywright_base::math::robust::{greater, lesser};

/// The bit of the level of the root; that of the next is half of it.
const TOP: u64 = 1 << 63;

const _: () = assert!(MAX_DEPTH < 64);

/// A node, and where the ray is in it at most, however near it has met something.
#[derive(Clone, Copy)]
struct At {
    node: u32,
    enter: f32,
    leave: f32,
    /// The bit of its level.
    level: u64,
}

/// A walk without a stack.
pub struct Walk<'a, const COUNTED: bool> {
    tree: &'a KdTree,
    planes: PlaneRay,
    /// Where to go down from; nothing where all is done.
    top: Option<At>,
    /// By level below that, whether the first side is done, or there is only one.
    trail: u64,
    nodes: u32,
}

impl<'a, const COUNTED: bool> Walk<'a, COUNTED> {
    /// Through a tree.
    pub fn new(tree: &'a KdTree) -> Self {
        Self { tree, planes: PlaneRay::new(&SlabRay::EVERYWHERE), top: None, trail: 0, nodes: 0 }
    }
}

impl<const COUNTED: bool> Walker for Walk<'_, COUNTED> {
    fn start(&mut self, ray: &SlabRay) {
        self.planes = PlaneRay::new(ray);
        self.nodes = u32::from(COUNTED);
        self.trail = 0;
        let passed = ray.passes(&self.tree.bounds, f32::INFINITY);
        self.top = passed.map(|(enter, leave)| At { node: 0, enter, leave, level: TOP });
    }

    fn next(&mut self, limit: f32) -> Option<u32> {
        let nodes = self.tree.nodes.as_slice();
        while let Some(mut at) = self.top {
            // The lowest node above which nothing is left, once it is known.
            let mut top = None;
            let leaf = loop {
                let node = nodes[at.node as usize];
                // All that is below lies as far away as this, or farther.
                if node.is_leaf() || at.enter > limit {
                    break node;
                }
                if COUNTED {
                    self.nodes += 1;
                }
                let sides = self.planes.sides(node.axis(), node.plane());
                let first = node.children() + sides.first;
                let here = at;
                at.level >>= 1;
                if sides.from > here.leave {
                    (at.node, self.trail) = (first, self.trail | here.level);
                } else if sides.until < here.enter {
                    (at.node, self.trail) = (first ^ 1, self.trail | here.level);
                } else if self.trail & here.level == 0 {
                    (at.node, at.leave) = (first, lesser(here.leave, sides.until));
                    top = top.or(Some(here));
                } else {
                    (at.node, at.enter) = (first ^ 1, greater(here.enter, sides.from));
                }
            };
            // One more at the level above: what is done there carries on upwards, and what lies below starts anew.
            let above = at.level << 1;
            self.trail = (self.trail & above.wrapping_neg()).wrapping_add(above);
            self.top = top;
            if leaf.is_leaf() && leaf.count() > 0 && at.enter <= limit {
                return Some(leaf.number());
            }
        }
        None
    }

    fn nodes(&self) -> u32 {
        self.nodes
    }
}
