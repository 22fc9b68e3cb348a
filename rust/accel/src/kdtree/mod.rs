//! kD-trees: space parted by planes across its axes, in nodes of 8 bytes.
//!
//! A node covers a cell of space and knows nothing but the plane that parts it; a primitive stands in every leaf whose
//! cell it has a part in. Cells do not overlap, so a ray comes to leaves strictly from the front, and what it meets in
//! the first ends its search.

mod build;
mod check;
mod node;
mod planes;
mod restart;
mod stack;

pub use build::{Builder, Options};
pub use node::Node;

use super::walk::{Input, Lists, Plane, Structure, Walker};
use super::{Info, NodeBox};
use raywright_base::math::Aabb;

/// Most levels below the root that may be asked for.
pub const MAX_DEPTH: usize = 60;

/// Ways through a kD-tree. Both come to the same leaves in the same order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Traversal {
    /// What is left for later is put on a stack.
    #[default]
    Stack,
    /// Nothing is: from each leaf on, the ray goes down again.
    Restart,
}

impl Traversal {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Stack, Self::Restart];

    /// As options call it.
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
    /// The first is the root. Every other pair is children of one node, which stands before it; the second is none's.
    nodes: Vec<Node>,
    /// The box around everything: the root's cell.
    bounds: Aabb,
    depth: usize,
    options: Options,
}

/// Builds a kD-tree over primitives.
///
/// It has the same bits for any number of threads. Time is n log n by the surface-area heuristic, where clipped parts
/// are counted in n, and n log² n at most otherwise; there are at most 9 times as many parts as primitives, and 64
/// more.
///
/// # Panics
/// If an option is out of range.
pub fn build(input: &Input, options: &Options) -> (Box<dyn Structure>, Lists) {
    let (nodes, lists, bounds) = build::build(input, options);
    let mut tree = KdTree { nodes, bounds, depth: 0, options: *options };
    tree.depth = tree.cells().map(|cell| cell.depth).max().unwrap_or(0);
    (Box::new(tree), lists)
}

/// A node with its cell.
struct Cell {
    node: usize,
    aabb: Aabb,
    depth: usize,
}

impl KdTree {
    /// Every node from the root on.
    fn cells(&self) -> impl Iterator<Item = Cell> {
        let mut open = Vec::new();
        if !self.nodes.is_empty() {
            open.push(Cell { node: 0, aabb: self.bounds, depth: 0 });
        }
        std::iter::from_fn(move || {
            let cell = open.pop()?;
            if let Some((plane, children)) = self.plane(cell.node) {
                let [below, above] = plane.cut(&cell.aabb);
                let depth = cell.depth + 1;
                open.push(Cell { node: children + 1, aabb: above, depth });
                open.push(Cell { node: children, aabb: below, depth });
            }
            Some(cell)
        })
    }

    /// Of an inner node, its plane and the first of its children.
    fn plane(&self, node: usize) -> Option<(Plane, usize)> {
        let node = self.nodes[node];
        let plane = || Plane { axis: node.axis(), at: node.plane() };
        (!node.is_leaf()).then(|| (plane(), node.children() as usize))
    }

    /// The surface-area heuristic's cost: of every inner node one test of a plane, of every leaf its primitives, each
    /// times the chance that a ray that meets the root's cell meets this one's.
    fn sah_cost(&self) -> f64 {
        let root = area(&self.bounds);
        let share = |cell: &Cell| if root > 0.0 { area(&cell.aabb) / root } else { 1.0 };
        let tests = |cell: &Cell| match self.nodes[cell.node] {
            node if node.is_leaf() => f64::from(node.count()),
            _ => 1.0,
        };
        self.cells().map(|cell| share(&cell) * tests(&cell)).sum()
    }
}

/// Half the surface, where an f32 may hold none of it.
fn area(aabb: &Aabb) -> f64 {
    let d = aabb.max.as_dvec3() - aabb.min.as_dvec3();
    d.x * (d.y + d.z) + d.y * d.z
}

impl Structure for KdTree {
    fn walker(&self, counted: bool) -> Box<dyn Walker + '_> {
        match (self.options.traversal, counted) {
            (Traversal::Stack, false) => Box::new(stack::Walk::<false>::new(self)),
            (Traversal::Stack, true) => Box::new(stack::Walk::<true>::new(self)),
            (Traversal::Restart, false) => Box::new(restart::Walk::<false>::new(self)),
            (Traversal::Restart, true) => Box::new(restart::Walk::<true>::new(self)),
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
        let of = |Cell { node, aabb, depth }: Cell| {
            let node = self.nodes[node];
            NodeBox { aabb, depth, primitives: node.is_leaf().then_some(node.count() as usize) }
        };
        Some(self.cells().map(of).collect())
    }

    fn validate(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<(), String> {
        check::check(self, input, primitives)
    }
}
