//! Subtrees built in parallel, before their final positions are known.

use super::reference::Reference;
use super::{BinaryBvh, Node};
use raywright_base::math::Aabb;
use raywright_base::parallel;
use raywright_base::work::{Stopped, Work};

/// A part of a tree.
pub enum Subtree {
    /// A subtree: its root and the nodes below it, whose indices start at 0 for the first of them.
    Whole {
        /// The root.
        root: Node,
        /// The nodes below the root.
        below: Vec<Node>,
        /// The primitives of its leaves, which refer to this list. Empty if they already refer to all primitives.
        order: Vec<u32>,
    },
    /// Two parts as siblings.
    Pair(Box<SiblingPair>),
}

/// Two parts as siblings.
pub struct SiblingPair {
    /// Their bounding box.
    aabb: Aabb,
    parts: [Subtree; 2],
    /// The number of nodes in both.
    nodes: usize,
    /// The number of listed primitives in both.
    listed: usize,
}

impl Subtree {
    /// A leaf that lists its primitives.
    pub fn leaf(aabb: Aabb, references: &[Reference]) -> Self {
        let order: Vec<_> = references.iter().map(Reference::primitive).collect();
        Self::Whole { root: Node::leaf(aabb, 0, order.len() as u32), below: Vec::new(), order }
    }

    /// Combine two parts as siblings.
    pub fn pair(aabb: Aabb, left: Self, right: Self) -> Self {
        let nodes = 2 + left.below() + right.below();
        let listed = left.listed() + right.listed();
        Self::Pair(Box::new(SiblingPair { aabb, parts: [left, right], nodes, listed }))
    }

    /// The number of nodes below its root.
    fn below(&self) -> usize {
        match self {
            Self::Whole { below, .. } => below.len(),
            Self::Pair(pair) => pair.nodes,
        }
    }

    /// The number of listed primitives.
    fn listed(&self) -> usize {
        match self {
            Self::Whole { order, .. } => order.len(),
            Self::Pair(pair) => pair.listed,
        }
    }

    /// Assemble the tree, over primitives in the given order or, if the parts list theirs, in that one.
    pub fn assemble(self, mut order: Vec<u32>, work: Work) -> Result<BinaryBvh, Stopped> {
        let [make, place] = work.parts([1.0, 3.0]);
        let mut nodes = make.collect(self.below() + 1, |_| Node::leaf(Aabb::EMPTY, 0, 0))?;
        let (root, below) = nodes.split_at_mut(1);
        if self.listed() > 0 {
            order = vec![0; self.listed()];
            self.place(&mut root[0], PartTarget { base: 1, below, first: 0, order: &mut order });
        } else {
            self.place(&mut root[0], PartTarget { base: 1, below, first: 0, order: &mut [] });
        }
        place.done();
        Ok(BinaryBvh { nodes, order })
    }

    /// Write its root and the nodes below.
    fn place(self, node: &mut Node, to: PartTarget) {
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
                let SiblingPair { aabb, parts: [left, right], .. } = *pair;
                let PartTarget { base, below, first, order } = to;
                *node = Node::inner(aabb, base as u32);
                let (children, below) = below.split_at_mut(2);
                let [left_node, right_node] = children else { unreachable!("split_at_mut(2) gives two") };
                let (left_below, right_below) = below.split_at_mut(left.below());
                let (left_order, right_order) = order.split_at_mut(left.listed());
                let right_to = PartTarget {
                    base: base + 2 + left_below.len(),
                    below: right_below,
                    first: first + left_order.len(),
                    order: right_order,
                };
                let left_to = PartTarget { base: base + 2, below: left_below, first, order: left_order };
                parallel::join(|| left.place(left_node, left_to), || right.place(right_node, right_to));
            }
        }
    }
}

/// The destination of a part.
struct PartTarget<'a> {
    /// The index of the first node below its root.
    base: usize,
    below: &'a mut [Node],
    /// The index of its first primitive in the order.
    first: usize,
    order: &'a mut [u32],
}
