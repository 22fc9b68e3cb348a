//! The top-down build of subtrees in parallel, generic over the split criterion.

use super::subtree::Subtree;
use super::{BinaryBvh, Node};
use raywright_base::math::Aabb;
use raywright_base::parallel;
use raywright_base::work::{Steps, Stopped, Work};

/// Maximum number of primitives of a subtree built by one thread.
pub const TASK: usize = 1024;

/// The progress to report once a subtree is built.
#[derive(Clone, Copy)]
pub struct Due<'a> {
    amount: usize,
    /// The number of levels it covers, at least one.
    levels: usize,
    steps: &'a Steps<'a>,
}

impl<'a> Due<'a> {
    /// Cost of building a small subtree, in passes over its primitives. A level of large nodes takes one pass.
    const BELOW: usize = 8;

    fn levels(count: usize) -> usize {
        (count / TASK).max(1).ilog2() as usize + Self::BELOW
    }

    /// Progress steps for a build of the given size.
    pub fn steps(count: usize, work: Work) -> Steps {
        work.steps(count * Self::levels(count))
    }

    /// All of these steps.
    pub fn all(count: usize, steps: &'a Steps<'a>) -> Self {
        let levels = Self::levels(count);
        Self { amount: count * levels, levels, steps }
    }

    /// Report that a set is split; return the shares of both sides, given their sizes.
    pub fn split(self, [left, right]: [usize; 2]) -> Result<[Self; 2], Stopped> {
        let Self { amount, levels, steps } = self;
        let now = amount / levels;
        steps.did(now)?;
        let rest = amount - now;
        let of_left = (rest as u128 * left as u128 / (left + right).max(1) as u128) as usize;
        Ok([of_left, rest - of_left].map(|amount| Self { amount, levels: levels.saturating_sub(1).max(1), steps }))
    }

    /// Report all of it.
    pub fn tell(self) -> Result<(), Stopped> {
        self.steps.did(self.amount)
    }
}

/// A set of primitives that may be split in two.
pub trait Set: Sized + Send {
    /// Scratch space, reused between splits.
    type Workspace: Default;

    /// The number of primitives, at least one.
    fn len(&self) -> usize;

    /// The bounding box.
    fn aabb(&self) -> Aabb;

    /// Split into two nonempty sets; return the set itself if it becomes a leaf.
    fn split(self, workspace: &mut Self::Workspace) -> Result<[Self; 2], Self>;

    /// Append the numbers of its primitives.
    fn list(&self, order: &mut Vec<u32>);
}

/// Build a tree over a set. The recursion is as deep as the tree.
pub fn build<S: Set>(set: S, work: Work) -> Result<BinaryBvh, Stopped> {
    let [grow, place] = work.parts([10.0, 1.0]);
    let count = set.len();
    let steps = Due::steps(count, grow);
    part(set, Due::all(count, &steps))?.assemble(Vec::new(), place)
}

fn part<S: Set>(set: S, due: Due) -> Result<Subtree, Stopped> {
    let below = if set.len() <= TASK {
        Err(set)
    } else {
        let aabb = set.aabb();
        set.split(&mut S::Workspace::default()).map(|sides| (aabb, sides))
    };
    match below {
        Ok((aabb, [left, right])) => {
            let [of_left, of_right] = due.split([left.len(), right.len()])?;
            let (left, right) = parallel::join(|| part(left, of_left), || part(right, of_right));
            Ok(Subtree::pair(aabb, left?, right?))
        }
        Err(leaf) => {
            let part = alone(leaf, &mut S::Workspace::default());
            due.tell()?;
            Ok(part)
        }
    }
}

/// Build a subtree on this thread.
fn alone<S: Set>(set: S, workspace: &mut S::Workspace) -> Subtree {
    let nothing = Node::leaf(Aabb::EMPTY, 0, 0);
    let (mut root, mut below, mut order) = (nothing, Vec::new(), Vec::with_capacity(set.len()));
    // Each with its index below the root; None for the root.
    let mut open: Vec<(Option<usize>, S)> = vec![(None, set)];
    while let Some((place, set)) = open.pop() {
        let aabb = set.aabb();
        let made = match set.split(workspace) {
            Ok([left, right]) => {
                let child = below.len();
                below.extend([nothing; 2]);
                // The stack is popped from the end, so the left subtree comes first.
                open.push((Some(child + 1), right));
                open.push((Some(child), left));
                Node::inner(aabb, child as u32)
            }
            Err(leaf) => {
                let first = order.len();
                leaf.list(&mut order);
                Node::leaf(aabb, first as u32, (order.len() - first) as u32)
            }
        };
        *place.map_or(&mut root, |place| &mut below[place]) = made;
    }
    Subtree::Whole { root, below, order }
}
