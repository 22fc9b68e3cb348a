//! kd-trees: space split by axis-aligned planes, in nodes of 8 bytes.
//!
//! A node covers a cell of space and stores only its splitting plane. A primitive is in every leaf whose cell it
//! overlaps. Cells are disjoint, so rays visit leaves strictly front to back, and a hit within a cell ends the
//! traversal.

mod build;
mod check;
mod node;
mod planes;
mod restart;
mod stack;

pub use build::{Builder, Options};
pub use node::Node;

use super::walk::{Input, Lists, SplitPlane, Structure, Walker};
use super::{Info, NodeBox};
use raywright_base::math::Aabb;

/// Maximum depth that may be requested.
pub const MAX_DEPTH: usize = 60;

/// Traversal algorithms. Both visit the same leaves in the same order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Traversal {
    /// With a stack of pending nodes.
    #[default]
    Stack,
    /// Without a stack: the ray restarts at the top after each leaf.
    Restart,
}

impl Traversal {
    /// All algorithms.
    pub const ALL: [Self; 2] = [Self::Stack, Self::Restart];

    /// The name in options.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stack => "stack",
            Self::Restart => "restart",
        }
    }
}

/// A kD-tree.
#[derive(Clone, Debug)]
pub struct KdTree {
    /// The nodes, root first. Children are in pairs after their parent; the second node is unused.
    nodes: Vec<Node>,
    /// The root's cell.
    bounds: Aabb,
    depth: usize,
    options: Options,
}

/// Build a kd-tree over primitives.
///
/// The result is bit-identical for any number of threads. The surface area heuristic takes n log n time, with n
/// counting clipped parts, and other builders at most n log² n. There are at most 9 times as many parts as primitives,
/// plus 64.
///
/// # Panics
///
/// If an option is out of range.
pub fn build(input: &Input, options: &Options) -> (Box<dyn Structure>, Lists) {
    let (nodes, lists, bounds) = build::build(input, options);
    let mut tree = KdTree { nodes, bounds, depth: 0, options: *options };
    tree.depth = tree.cells().map(|cell| cell.depth).max().unwrap_or(0);
    (Box::new(tree), lists)
}

/// A node and its cell.
struct KdCell {
    node: usize,
    aabb: Aabb,
    depth: usize,
}

impl KdTree {
    /// All nodes, root first.
    fn cells(&self) -> impl Iterator<Item = KdCell> {
        let mut open = Vec::new();
        if !self.nodes.is_empty() {
            open.push(KdCell { node: 0, aabb: self.bounds, depth: 0 });
        }
        std::iter::from_fn(move || {
            let cell = open.pop()?;
            if let Some((plane, children)) = self.plane(cell.node) {
                let [below, above] = plane.cut(&cell.aabb);
                let depth = cell.depth + 1;
                open.push(KdCell { node: children + 1, aabb: above, depth });
                open.push(KdCell { node: children, aabb: below, depth });
            }
            Some(cell)
        })
    }

    /// The plane and first child of an inner node.
    fn plane(&self, node: usize) -> Option<(SplitPlane, usize)> {
        let node = self.nodes[node];
        let plane = || SplitPlane { axis: node.axis(), at: node.plane() };
        (!node.is_leaf()).then(|| (plane(), node.children() as usize))
    }

    /// The cost by the surface area heuristic: one plane test per inner node, plus the primitives of each leaf, each
    /// times the probability that a ray through the root's cell hits the cell.
    fn sah_cost(&self) -> f64 {
        let root = area(&self.bounds);
        let share = |cell: &KdCell| if root > 0.0 { area(&cell.aabb) / root } else { 1.0 };
        let tests = |cell: &KdCell| match self.nodes[cell.node] {
            node if node.is_leaf() => f64::from(node.count()),
            _ => 1.0,
        };
        self.cells().map(|cell| share(&cell) * tests(&cell)).sum()
    }
}

/// Half the surface area in f64, since it may underflow in f32.
fn area(aabb: &Aabb) -> f64 {
    let d = aabb.max.as_dvec3() - aabb.min.as_dvec3();
    d.x * (d.y + d.z) + d.y * d.z
}

impl Structure for KdTree {
    fn walker(&self, counted: bool) -> Box<dyn Walker + '_> {
        match (self.options.traversal, counted) {
            (Traversal::Stack, false) => Box::new(stack::StackTraversal::<false>::new(self)),
            (Traversal::Stack, true) => Box::new(stack::StackTraversal::<true>::new(self)),
            (Traversal::Restart, false) => Box::new(restart::RestartTraversal::<false>::new(self)),
            (Traversal::Restart, true) => Box::new(restart::RestartTraversal::<true>::new(self)),
        }
    }

    fn info(&self) -> Info {
        let leaves = self.cells().filter(|cell| self.nodes[cell.node].is_leaf()).count();
        let Options { builder, traversal, .. } = self.options;
        Info {
            kind: format!("kD-tree, {}, {}", builder.name(), traversal.name()),
            nodes: leaves.saturating_sub(1),
            leaves,
            depth: self.depth,
            bytes: size_of_val(self.nodes.as_slice()),
            sah_cost: self.sah_cost(),
            ..Info::default()
        }
    }

    fn boxes(&self, _: &dyn Fn(u32) -> usize) -> Option<Vec<NodeBox>> {
        let of = |KdCell { node, aabb, depth }: KdCell| {
            let node = self.nodes[node];
            NodeBox { aabb, depth, primitives: node.is_leaf().then_some(node.count() as usize) }
        };
        Some(self.cells().map(of).collect())
    }

    fn validate(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<(), String> {
        check::check(self, input, primitives)
    }
}
