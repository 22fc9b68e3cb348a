//! Binary trees with one primitive a leaf, written where they belong at once: a subtree over n of them has 2 n − 1
//! nodes, so every place is known beforehand.

use super::{BinaryBvh, Node};
use crate::math::Aabb;
use rayon::prelude::*;

/// Subtrees over up to so many primitives are written by one thread.
const TASK: usize = 1024;

/// A subtree that is yet to be written.
pub trait Subtree: Copy + Send + Sync {
    /// What it turns out to be.
    fn open(self) -> Opened<Self>;
}

/// What a subtree turns out to be.
pub enum Opened<S> {
    /// A leaf: its box and its primitive.
    Leaf(Aabb, u32),
    /// Two subtrees, and over how many primitives the first is.
    Pair(S, S, usize),
}

/// Writes a tree over so many primitives, at least one; boxes come from the bottom up. Subtrees must not be nested much
/// deeper than a stack can hold.
pub fn write(root: impl Subtree, count: usize) -> BinaryBvh {
    let nothing = Node::leaf(Aabb::EMPTY, 0, 0);
    let mut nodes: Vec<Node> = (0..2 * count - 1).into_par_iter().map(|_| nothing).collect();
    let mut order = vec![0; count];
    let (top, below) = nodes.split_at_mut(1);
    subtree(root, &mut top[0], 1, below, 0, &mut order);
    BinaryBvh { nodes, order }
}

/// Writes a subtree: its root, what is below from the node `base` on, and its primitives from the place `first` on.
fn subtree(tree: impl Subtree, root: &mut Node, base: usize, below: &mut [Node], first: usize, order: &mut [u32]) {
    match tree.open() {
        Opened::Leaf(aabb, primitive) => {
            order[0] = primitive;
            *root = Node::leaf(aabb, first as u32, 1);
        }
        Opened::Pair(left, right, count) => {
            let parallel = order.len() > TASK;
            let (children, below) = below.split_at_mut(2);
            let [left_root, right_root] = children else { unreachable!("split_at_mut(2) gives two") };
            let (left_below, right_below) = below.split_at_mut(2 * count - 2);
            let (left_order, right_order) = order.split_at_mut(count);
            let right_base = base + 2 + left_below.len();
            let mut write_left = || subtree(left, left_root, base + 2, left_below, first, left_order);
            let mut write_right = || subtree(right, right_root, right_base, right_below, first + count, right_order);
            if parallel {
                rayon::join(write_left, write_right);
            } else {
                write_left();
                write_right();
            }
            *root = Node::inner(children[0].aabb().union(children[1].aabb()), base as u32);
        }
    }
}
