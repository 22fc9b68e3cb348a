//! Stack-based kd-tree traversal: the near side first, the far side pushed with its interval of the ray (Havran,
//! "Heuristic Ray Shooting Algorithms", 2000; for later variants see Hapala and Havran, "Review: Kd-tree Traversal
//! Algorithms for Ray Tracing", 2011).

use super::planes::PlaneRay;
use super::{KdTree, MAX_DEPTH};
use crate::SlabRay;
use crate::walk::Walker;
use raywright_base::math::robust::{greater, lesser};

/// A path leaves one pending node per level. A power of two, so that masked indices need no bounds check.
const STACK: usize = 64;

const _: () = assert!(MAX_DEPTH < STACK);

/// A node and the interval in which the ray may be inside.
#[derive(Clone, Copy)]
struct StackEntry {
    node: u32,
    enter: f32,
    leave: f32,
}

/// A traversal with a stack.
pub struct StackTraversal<'a, const COUNTED: bool> {
    tree: &'a KdTree,
    planes: PlaneRay,
    open: [StackEntry; STACK],
    /// Height of the stack.
    height: usize,
    nodes: u32,
}

impl<'a, const COUNTED: bool> StackTraversal<'a, COUNTED> {
    /// Create a traversal of a tree.
    pub fn new(tree: &'a KdTree) -> Self {
        let nothing = StackEntry { node: 0, enter: 0.0, leave: 0.0 };
        Self { tree, planes: PlaneRay::new(&SlabRay::EVERYWHERE), open: [nothing; STACK], height: 0, nodes: 0 }
    }
}

impl<const COUNTED: bool> Walker for StackTraversal<'_, COUNTED> {
    fn start(&mut self, ray: &SlabRay) {
        self.planes = PlaneRay::new(ray);
        self.height = 0;
        self.nodes = u32::from(COUNTED);
        if let Some((enter, leave)) = ray.passes(&self.tree.bounds, f32::INFINITY) {
            self.open[0] = StackEntry { node: 0, enter, leave };
            self.height = 1;
        }
    }

    fn next(&mut self, limit: f32) -> Option<u32> {
        let nodes = self.tree.nodes.as_slice();
        let mut height = self.height;
        while height > 0 {
            height -= 1;
            let StackEntry { node: mut at, enter, leave } = self.open[height % STACK];
            if enter > limit {
                continue;
            }
            let mut leave = lesser(leave, limit);
            let leaf = loop {
                let node = nodes[at as usize];
                if node.is_leaf() {
                    break node;
                }
                if COUNTED {
                    self.nodes += 1;
                }
                // Branches are faster than arithmetic here: with arithmetic the ray waits for each node, whereas
                // branches allow speculation.
                let sides = self.planes.sides(node.axis(), node.plane());
                at = node.children() + sides.first;
                if sides.from > leave {
                    continue;
                }
                if sides.until < enter {
                    at ^= 1;
                    continue;
                }
                self.open[height % STACK] = StackEntry { node: at ^ 1, enter: greater(enter, sides.from), leave };
                height += 1;
                leave = lesser(leave, sides.until);
            };
            if leaf.count() > 0 {
                self.height = height;
                return Some(leaf.number());
            }
        }
        self.height = 0;
        None
    }

    fn nodes(&self) -> u32 {
        self.nodes
    }
}
