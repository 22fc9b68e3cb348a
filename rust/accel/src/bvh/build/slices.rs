//! Binary trees with one primitive per leaf, written in place: a subtree over n primitives has 2 n − 1 nodes, so all
//! positions are known in advance.

use super::{BinaryBvh, Node};
use raywright_base::math::Aabb;
use raywright_base::parallel;
use raywright_base::work::{Steps, Stopped, Work};

/// Maximum number of primitives of a subtree written by one thread.
const TASK: usize = 1024;

/// A subtree to be written.
pub trait Subtree: Copy + Send + Sync {
    /// Expand it by one level.
    fn open(self) -> Opened<Self>;
}

/// An expanded subtree.
pub enum Opened<S> {
    /// A leaf: its box and its primitive.
    Leaf(Aabb, u32),
    /// Two subtrees, and the number of primitives in the first.
    Pair(S, S, usize),
}

/// Write a tree over at least one primitive, with boxes computed bottom-up. The recursion is as deep as the tree.
pub fn write(root: impl Subtree, count: usize, work: Work) -> Result<BinaryBvh, Stopped> {
    let [make, fill] = work.parts([1.0, 8.0]);
    let mut nodes = make.collect(2 * count - 1, |_| Node::leaf(Aabb::EMPTY, 0, 0))?;
    let (mut order, steps) = (vec![0; count], fill.steps(count));
    let (top, below) = nodes.split_at_mut(1);
    subtree(root, &mut top[0], SliceTarget { base: 1, below, first: 0, order: &mut order }, &steps)?;
    fill.done();
    Ok(BinaryBvh { nodes, order })
}

/// The destination of a subtree.
struct SliceTarget<'a> {
    /// The index of the first node below its root.
    base: usize,
    below: &'a mut [Node],
    /// The index of its first primitive in the order.
    first: usize,
    order: &'a mut [u32],
}

/// Write a subtree: its root, the nodes below, and its primitives.
fn subtree(tree: impl Subtree, root: &mut Node, to: SliceTarget, steps: &Steps) -> Result<(), Stopped> {
    let SliceTarget { base, below, first, order } = to;
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
            let left_to = SliceTarget { base: base + 2, below: left_below, first, order: left_order };
            let right_to =
                SliceTarget { base: right_base, below: right_below, first: first + count, order: right_order };
            // Progress is reported once per single-threaded subtree.
            let told = |count: usize| if parallel && count <= TASK { steps.did(count) } else { Ok(()) };
            let (left_count, right_count) = (left_to.order.len(), right_to.order.len());
            let write_left = || subtree(left, left_root, left_to, steps).and_then(|()| told(left_count));
            let write_right = || subtree(right, right_root, right_to, steps).and_then(|()| told(right_count));
            let written =
                if parallel { parallel::join(write_left, write_right) } else { (write_left(), write_right()) };
            written.0.and(written.1)?;
            *root = Node::inner(children[0].aabb().union(children[1].aabb()), base as u32);
        }
    }
    Ok(())
}
