//! Subtrees before they have a place: how long one gets is known only when it is built.

use super::{BinaryBvh, Node};
use crate::math::Aabb;
use rayon::prelude::*;

/// A part of a tree.
pub enum Part {
    /// A subtree: its root, and what is below, whose places are counted from the first below the root.
    Whole {
        /// The root.
        root: Node,
        /// What is below.
        below: Vec<Node>,
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
}

impl Part {
    /// Puts two parts side by side.
    pub fn pair(aabb: Aabb, left: Self, right: Self) -> Self {
        let nodes = 2 + left.below() + right.below();
        Self::Pair(Box::new(Pair { aabb, parts: [left, right], nodes }))
    }

    /// How many nodes there are below its root.
    fn below(&self) -> usize {
        match self {
            Self::Whole { below, .. } => below.len(),
            Self::Pair(pair) => pair.nodes,
        }
    }

    /// Makes a tree of it, over primitives in some order.
    pub fn assemble(self, order: Vec<u32>) -> BinaryBvh {
        let mut nodes: Vec<Node> = (0..=self.below()).into_par_iter().map(|_| Node::leaf(Aabb::EMPTY, 0, 0)).collect();
        let (root, below) = nodes.split_at_mut(1);
        self.place(&mut root[0], 1, below);
        BinaryBvh { nodes, order }
    }

    /// Writes its root, and what is below, whose first node has the number `base`.
    fn place(self, node: &mut Node, base: usize, to: &mut [Node]) {
        match self {
            Self::Whole { root, below } => {
                let moved = |n: &Node| if n.is_leaf() { *n } else { Node { index: n.index + base as u32, ..*n } };
                *node = moved(&root);
                for (to, n) in to.iter_mut().zip(&below) {
                    *to = moved(n);
                }
            }
            Self::Pair(pair) => {
                let Pair { aabb, parts: [left, right], .. } = *pair;
                *node = Node::inner(aabb, base as u32);
                let (children, to) = to.split_at_mut(2);
                let [left_node, right_node] = children else { unreachable!("split_at_mut(2) gives two") };
                let (left_to, right_to) = to.split_at_mut(left.below());
                let right_base = base + 2 + left_to.len();
                rayon::join(
                    || left.place(left_node, base + 2, left_to),
                    || right.place(right_node, right_base, right_to),
                );
            }
        }
    }
}
