//! Stackless kd-tree traversal. After a leaf the ray restarts at the root (Foley and Sugerman, "KD-Tree Acceleration
//! Structures for a GPU Raytracer", 2005), or at the lowest node that contains all remaining work (push-down; Horn,
//! Sugerman, Houston and Hanrahan, "Interactive k-D Tree GPU Raytracing", 2007).
//!
//! Near a plane it is uncertain on which side of it a ray is, so `t` alone does not tell which leaves were visited. One
//! bit per level does: whether the near side is done (Laine, "Restart Trail for Stackless BVH Traversal", 2010). So the
//! leaves and their order are the same as with a stack.

use super::planes::PlaneRay;
use super::{KdTree, MAX_DEPTH};
use crate::SlabRay;
use crate::walk::Walker;
use raywright_base::math::robust::{greater, lesser};

/// The bit of the root's level; each further level has half of it.
const TOP: u64 = 1 << 63;

const _: () = assert!(MAX_DEPTH < 64);

/// A node and the interval in which the ray may be inside, regardless of hits.
#[derive(Clone, Copy)]
struct RayPosition {
    node: u32,
    enter: f32,
    leave: f32,
    /// The bit of its level.
    level: u64,
}

/// A stackless traversal.
pub struct RestartTraversal<'a, const COUNTED: bool> {
    tree: &'a KdTree,
    planes: PlaneRay,
    /// The restart node; None when done.
    top: Option<RayPosition>,
    /// The restart trail: by level, whether the near side is done or there is only one side.
    trail: u64,
    nodes: u32,
}

impl<'a, const COUNTED: bool> RestartTraversal<'a, COUNTED> {
    /// Create a traversal of a tree.
    pub fn new(tree: &'a KdTree) -> Self {
        Self { tree, planes: PlaneRay::new(&SlabRay::EVERYWHERE), top: None, trail: 0, nodes: 0 }
    }
}

impl<const COUNTED: bool> Walker for RestartTraversal<'_, COUNTED> {
    fn start(&mut self, ray: &SlabRay) {
        self.planes = PlaneRay::new(ray);
        self.nodes = u32::from(COUNTED);
        self.trail = 0;
        let passed = ray.passes(&self.tree.bounds, f32::INFINITY);
        self.top = passed.map(|(enter, leave)| RayPosition { node: 0, enter, leave, level: TOP });
    }

    fn next(&mut self, limit: f32) -> Option<u32> {
        let nodes = self.tree.nodes.as_slice();
        while let Some(mut at) = self.top {
            // The lowest node with no remaining work above it, once known.
            let mut top = None;
            let leaf = loop {
                let node = nodes[at.node as usize];
                // Everything below is at least as far.
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
            // Add one at the level above: a carry marks finished levels upward, and the levels below start again.
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
