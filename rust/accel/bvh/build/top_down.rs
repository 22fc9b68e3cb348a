//! From the top down, subtree by subtree, whatever decides on the splits.

use super::part::Part;
use super::{BinaryBvh, Node};
use crate::math::Aabb;
use crate::work::{Steps, Stopped, Work};

/// Up to so many primitives, a subtree is built by one thread.
pub const TASK: usize = 1024;

/// How many times it takes to go through so many primitives: once a level as long as subtrees are large, and what is
/// below takes as long as so many of these.
pub fn levels(count: usize) -> usize {
    const BELOW: usize = 8;
    (count / TASK).max(1).ilog2() as usize + BELOW
}

/// A set of primitives that may be split in two.
pub trait Set: Sized + Send {
    /// What is reused from split to split.
    type Workspace: Default;

    /// How many there are, at least one.
    fn len(&self) -> usize;

    /// The box around them.
    fn aabb(&self) -> Aabb;

    /// Two sets of it, neither empty; or itself, if it is to be a leaf.
    fn split(self, workspace: &mut Self::Workspace) -> Result<[Self; 2], Self>;

    /// Adds the numbers of its primitives.
    fn list(&self, order: &mut Vec<u32>);
}

/// Builds a tree over a set. The sets must not be split much more often in a row than a stack can hold.
pub fn build<S: Set>(set: S, work: Work) -> Result<BinaryBvh, Stopped> {
    let [grow, place] = work.parts([10.0, 1.0]);
    let levels = levels(set.len());
    let steps = grow.steps(levels * set.len());
    part(set, levels, &steps)?.assemble(Vec::new(), place)
}

/// A subtree; `levels` is how many times its primitives count as gone through when it is done.
fn part<S: Set>(set: S, levels: usize, steps: &Steps) -> Result<Part, Stopped> {
    let count = set.len();
    let below = if count <= TASK {
        Err(set)
    } else {
        let aabb = set.aabb();
        set.split(&mut S::Workspace::default()).map(|sides| (aabb, sides))
    };
    match below {
        Ok((aabb, [left, right])) => {
            steps.did(count * levels.min(1))?;
            let levels = levels.saturating_sub(1);
            let (left, right) = rayon::join(|| part(left, levels, steps), || part(right, levels, steps));
            Ok(Part::pair(aabb, left?, right?))
        }
        Err(leaf) => {
            let part = alone(leaf, &mut S::Workspace::default());
            steps.did(count * levels)?;
            Ok(part)
        }
    }
}

/// Builds a subtree on this thread.
fn alone<S: Set>(set: S, workspace: &mut S::Workspace) -> Part {
    let nothing = Node::leaf(Aabb::EMPTY, 0, 0);
    let (mut root, mut below, mut order) = (nothing, Vec::new(), Vec::with_capacity(set.len()));
    // With its place below the root, or none for the root.
    let mut open: Vec<(Option<usize>, S)> = vec![(None, set)];
    while let Some((place, set)) = open.pop() {
        let aabb = set.aabb();
        let made = match set.split(workspace) {
            Ok([left, right]) => {
                let child = below.len();
                below.extend([nothing; 2]);
                // The last is taken first, so that what is below the left child comes first.
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
    Part::Whole { root, below, order }
}
