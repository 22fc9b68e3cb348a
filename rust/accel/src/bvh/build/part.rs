//! Subtrees before they have a place: how long one gets is known only when it is built.

use super::reference::Reference;
use super::{BinaryBvh, Node};
use raywright_base::math::Aabb;
use raywright_base::parallel;
use raywright_base::work::{Stopped, Work};

/// A part of a tree.
pub enum Part {
    /// A subtree: its root, and what is below, whose places are counted from the first below the root.
    Whole {
        /// The root.
        root: Node,
        /// What is below.
        below: Vec<Node>,
        /// The primitives of its leaves, which say where theirs begin in this list. Empty if they already say where
        /// among all primitives.
        order: Vec<u32>,
    },
    /// Two parts side by side.
    Pair(Box<Pair>),
}

/// Two parts side by side.
pub struct Pair {
    /// The box around them.
    aabb: Aabb,
    parts: [Part; 2],
    /// How many nodes there are in both.
    nodes: usize,
    /// How many primitives they list.
    listed: usize,
}

impl Part {
    /// A leaf that lists what is in it.
    pub fn leaf(aabb: Aabb, references: &[Reference]) -> Self {
        let order: Vec<_> = references.iter().map(Reference::primitive).collect();
        Self::Whole { root: Node::leaf(aabb, 0, order.len() as u32), below: Vec::new(), order }
    }

    /// Puts two parts side by side.
    pub fn pair(aabb: Aabb, left: Self, right: Self) -> Self {
        let nodes = 2 + left.below() + right.below();
        let listed = left.listed() + right.listed();
        Self::Pair(Box::new(Pair { aabb, parts: [left, right], nodes, listed }))
    }

    /// How many nodes there are below its root.
    fn below(&self) -> usize {
        match self {
            Self::Whole { below, .. } => below.len(),
            Self::Pair(pair) => pair.nodes,
        }
    }

    /// How many primitives it lists.
    fn listed(&self) -> usize {
        match self {
            Self::Whole { order, .. } => order.len(),
            Self::Pair(pair) => pair.listed,
        }
    }

    /// Makes a tree of it, over primitives in some order: that which the parts list, if they do.
    pub fn assemble(self, mut order: Vec<u32>, work: Work) -> Result<BinaryBvh, Stopped> {
        let [make, place] = work.parts([1.0, 3.0]);
        let mut nodes = make.collect(self.below() + 1, |_| Node::leaf(Aabb::EMPTY, 0, 0))?;
        let (root, below) = nodes.split_at_mut(1);
        if self.listed() > 0 {
            order = vec![0; self.listed()];
            self.place(&mut root[0], Target { base: 1, below, first: 0, order: &mut order });
        } else {
            self.place(&mut root[0], Target { base: 1, below, first: 0, order: &mut [] });
        }
        place.done();
        Ok(BinaryBvh { nodes, order })
    }

    /// Writes its root, and what is below.
    fn place(self, node: &mut Node, to: Target) {
        match self {
            Self::Whole { root, below, order } => {
                let moved =
                    |n: &Node| Node { index: n.index + if n.is_leaf() { to.first } else { to.base } as u32, ..*n };
                *node = moved(&root);
                for (to, n) in to.below.iter_mut().zip(&below) {
                    *to = moved(n);
                }
                to.order.copy_from_slice(&order);
            }
            Self::Pair(pair) => {
                let Pair { aabb, parts: [left, right], .. } = *pair;
                let Target { base, below, first, order } = to;
                *node = Node::inner(aabb, base as u32);
                let (children, below) = below.split_at_mut(2);
                let [left_node, right_node] = children else { unreachable!("split_at_mut(2) gives two") };
                let (left_below, right_below) = below.split_at_mut(left.below());
                let (left_order, right_order) = order.split_at_mut(left.listed());
                let right_to = Target {
                    base: base + 2 + left_below.len(),
                    below: right_below,
                    first: first + left_order.len(),
                    order: right_order,
                };
                let left_to = Target { base: base + 2, below: left_below, first, order: left_order };
                parallel::join(|| left.place(left_node, left_to), || right.place(right_node, right_to));
            }
        }
    }
}

/// Where a part is written.
struct Target<'a> {
    /// The number of the first node below its root.
    base: usize,
    below: &'a mut [Node],
    /// The place of its first primitive in the order.
    first: usize,
    order: &'a mut [u32],
}
