//! Top-down by the surface-area heuristic in bins, on all cores.
//!
//! Splits down to a few primitives a leaf. How many go into one leaf of the tree that rays walk is decided when it is
//! collapsed, where the cost of a block of triangles is known.

use super::bins::{Bins, SHARE, Split};
use super::part::Part;
use super::{BinaryBvh, Bounds, Extents, Node, Reference};
use crate::math::Aabb;
use rayon::prelude::*;

pub use super::bins::MAX_BINS;

/// How to build.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Bins an axis, from 2 to [`MAX_BINS`].
    pub bins: usize,
    /// How many primitives will fit a block of the tree that rays walk, from 1 to [`MAX_BLOCK`]. How so few are split hardly
    /// matters, and is decided quickly; three eighths of them are not split at all.
    pub block: usize,
}

/// Most primitives in a block that may be asked for.
pub const MAX_BLOCK: usize = 16;

/// Up to so many primitives, a subtree is built by one thread.
const TASK: usize = 1024;

/// From so many primitives on a node is binned by several threads.
const PARALLEL_BINNING: usize = 1 << 16;

/// Builds a tree over boxes, leaving out empty ones.
///
/// Takes time n log n on any input: a split that makes no progress by area gives way to the median, and so do all
/// splits from a depth on that a reasonable tree does not reach.
///
/// # Panics
/// If an option is out of range.
pub fn build(boxes: &[Aabb], options: &Options) -> BinaryBvh {
    let Options { bins, block } = *options;
    assert!((2..=MAX_BINS).contains(&bins), "bins is {bins}, not from 2 to {MAX_BINS}");
    assert!((1..=MAX_BLOCK).contains(&block), "block is {block}, not from 1 to {MAX_BLOCK}");
    let mut references = references(boxes);
    if references.is_empty() {
        return BinaryBvh::default();
    }
    let spare = 2 * references.len().ilog2() as usize + 40;
    let task = Task { bins, block, leaf: (3 * block).div_ceil(8), first: 0, spare };
    let extents = around(&references);
    let part = task.build(&mut references, extents);
    let order = references.par_iter().map(Reference::primitive).collect();
    drop(references);
    part.assemble(order)
}

/// References to all boxes but empty ones.
fn references(boxes: &[Aabb]) -> Vec<Reference> {
    let numbered = || boxes.par_iter().enumerate();
    let reference = |(i, b): (usize, &Aabb)| Reference::new(b, i as u32);
    if numbered().any(|(_, b)| b.is_empty()) {
        numbered().filter(|(_, b)| !b.is_empty()).map(reference).collect()
    } else {
        // Where each belongs is known, so it is written there at once.
        numbered().map(reference).collect()
    }
}

fn around(references: &[Reference]) -> Extents {
    if references.len() < PARALLEL_BINNING {
        Extents::around(references)
    } else {
        references.par_chunks(SHARE).map(Extents::around).reduce(|| Extents::EMPTY, Extents::union)
    }
}

/// What to build of a slice of the references.
#[derive(Clone, Copy)]
struct Task {
    bins: usize,
    block: usize,
    /// So many primitives are not split any more.
    leaf: usize,
    /// The first primitive, as leaves refer to it.
    first: u32,
    /// How many more levels may be split by area.
    spare: usize,
}

impl Task {
    fn build(self, references: &mut [Reference], extents: Extents) -> Part {
        if references.len() <= TASK {
            return self.build_alone(references, extents);
        }
        let by_area = if self.spare == 0 {
            None
        } else if references.len() < PARALLEL_BINNING {
            Split::best(references, &extents, self.bins, &mut Bins::new())
        } else {
            Split::best_of_many(references, &extents, self.bins)
        };
        let middle = match by_area {
            Some(split) => partition(references, &split),
            None => median(references, &extents.centres),
        };
        let (left, right) = references.split_at_mut(middle);
        let left_task = Self { spare: self.spare.saturating_sub(1), ..self };
        let right_task = Self { first: self.first + middle as u32, ..left_task };
        let (left, right) =
            rayon::join(|| left_task.build(left, around(left)), || right_task.build(right, around(right)));
        Part::pair(extents.all.aabb(), left, right)
    }

    /// Builds a subtree on this thread.
    fn build_alone(self, references: &mut [Reference], extents: Extents) -> Part {
        /// A node to be made.
        struct Open {
            /// Its place below the root, or none for the root.
            node: Option<usize>,
            start: usize,
            end: usize,
            extents: Extents,
            spare: usize,
        }
        let nothing = Node::leaf(Aabb::EMPTY, 0, 0);
        let (mut root, mut below) = (nothing, Vec::with_capacity(references.len()));
        let mut bins = Bins::new();
        let mut open = vec![Open { node: None, start: 0, end: references.len(), extents, spare: self.spare }];
        while let Some(Open { node, start, end, extents, spare }) = open.pop() {
            let own = &mut references[start..end];
            let aabb = extents.all.aabb();
            let child = below.len();
            let made = if own.len() <= self.leaf {
                Node::leaf(aabb, self.first + start as u32, own.len() as u32)
            } else {
                Node::inner(aabb, child as u32)
            };
            *node.map_or(&mut root, |node| &mut below[node]) = made;
            if made.is_leaf() {
                continue;
            }
            let middle = if own.len() <= self.block.max(2) {
                sweep(own, extents.centres.longest())
            } else {
                let by_area = if spare > 0 { Split::best(own, &extents, self.bins, &mut bins) } else { None };
                match by_area {
                    Some(split) => partition(own, &split),
                    None => median(own, &extents.centres),
                }
            };
            let (left, right) = own.split_at(middle);
            let (left, right) = (Extents::around(left), Extents::around(right));
            let (middle, spare) = (start + middle, spare.saturating_sub(1));
            below.extend([nothing; 2]);
            // The last is taken first, so that what is below the left child comes first.
            open.push(Open { node: Some(child + 1), start: middle, end, extents: right, spare });
            open.push(Open { node: Some(child), start, end: middle, extents: left, spare });
        }
        Part::Whole { root, below }
    }
}

/// Brings all on the left of a split to the front and tells how many they are. Without a branch on the side, which would
/// be guessed wrong every other time.
#[inline(always)]
fn partition(references: &mut [Reference], split: &Split) -> usize {
    let mut left = 0;
    for i in 0..references.len() {
        references.swap(i, left);
        left += usize::from(split.is_left(&references[left]));
    }
    left
}

/// Sorts at most [`MAX_BLOCK`] along an axis and tells where to split them, by the surface-area heuristic.
#[inline(always)]
fn sweep(references: &mut [Reference], axis: usize) -> usize {
    let n = references.len();
    for i in 1..n {
        let reference = references[i];
        let mut place = i;
        while place > 0 && references[place - 1].centre_on(axis) > reference.centre_on(axis) {
            references[place] = references[place - 1];
            place -= 1;
        }
        references[place] = reference;
    }
    let mut right = [0.0; MAX_BLOCK];
    let mut grown = Bounds::EMPTY;
    for i in (1..n).rev() {
        grown.grow(&references[i].bounds);
        right[i] = grown.half_area() * (n - i) as f32;
    }
    let mut grown = Bounds::EMPTY;
    let (mut least, mut best) = (f32::INFINITY, n / 2);
    for i in 1..n {
        grown.grow(&references[i - 1].bounds);
        let cost = grown.half_area() * i as f32 + right[i];
        if cost < least {
            (least, best) = (cost, i);
        }
    }
    best
}

/// Halves by number along the longest axis of the centres; equal centres by their primitive's number.
fn median(references: &mut [Reference], centres: &Bounds) -> usize {
    let axis = centres.longest();
    let middle = references.len() / 2;
    references.select_nth_unstable_by(middle, |a, b| {
        a.centre_on(axis).total_cmp(&b.centre_on(axis)).then(a.primitive().cmp(&b.primitive()))
    });
    middle
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::bvh::build::assert_depth_first;
    use glam::Vec3;
    use proptest::prelude::*;

    fn check(boxes: &[Aabb], block: usize) -> BinaryBvh {
        let bvh = build(boxes, &Options { bins: 16, block });
        bvh.validate(boxes).unwrap();
        let n = boxes.iter().filter(|b| !b.is_empty()).count();
        assert_eq!(bvh.order.len(), n);
        let limit = if n > 0 { 3 * n.ilog2() as usize + 42 + block } else { 0 };
        assert!(bvh.depth() <= limit, "depth {} for {n} boxes", bvh.depth());
        assert!(bvh.nodes.iter().all(|n| n.count as usize <= (3 * block).div_ceil(8)));
        assert_depth_first(&bvh);
        bvh
    }

    fn point(p: [f32; 3]) -> Aabb {
        Aabb::around([Vec3::from(p)])
    }

    proptest! {
        #[test]
        fn trees_over_any_boxes_are_valid(corners in prop::collection::vec(([-2f32..2.0, -2f32..2.0, -2f32..2.0], [0f32..0.5, 0f32..0.5, 0f32..0.5]), 0..300), block in 1..=MAX_BLOCK) {
            let boxes: Vec<_> = corners
                .iter()
                .map(|(p, d)| Aabb { min: Vec3::from(*p), max: Vec3::from(*p) + Vec3::from(*d) })
                .collect();
            check(&boxes, block);
        }
    }

    #[test]
    fn empty_boxes_are_left_out() {
        assert!(check(&[], 1).nodes.is_empty());
        assert!(check(&[Aabb::EMPTY; 3], 1).nodes.is_empty());
        assert_eq!(check(&[Aabb::EMPTY, point([1.0; 3]), Aabb::EMPTY], 1).order, [1]);
    }

    #[test]
    fn with_blocks_of_one_every_leaf_has_one() {
        let boxes: Vec<_> = (0..5000).map(|i| point([i as f32, (i * i % 91) as f32, 0.0])).collect();
        assert_eq!(check(&boxes, 1).nodes.len(), 2 * boxes.len() - 1);
    }

    #[test]
    fn coinciding_boxes_are_halved() {
        let bvh = check(&vec![point([0.5; 3]); 100_000], 1);
        assert_eq!(bvh.depth(), 17);
    }

    #[test]
    fn two_groups_apart_are_parted_first() {
        // Where the gap is, no plane cuts a box and both sides are smallest.
        let boxes: Vec<_> =
            (0..300).map(|i| point([if i % 3 == 0 { 9.0 } else { 0.0 } + 1e-3 * i as f32, 0.0, 0.5])).collect();
        let bvh = check(&boxes, 8);
        let [left, right] = bvh.nodes[0].children().map(|child| bvh.nodes[child].aabb());
        assert!(left.max.x < 1.0 && right.min.x >= 9.0);
    }

    #[test]
    fn a_staircase_of_scales_stays_shallow() {
        // Each box holds all that come before it, and equal bins can cut off only one at a time.
        let boxes: Vec<_> = (0..40_000)
            .map(|i| {
                let s = 1.0 - 0.9997f32.powi(i);
                Aabb { min: Vec3::ZERO, max: Vec3::splat(s) }
            })
            .collect();
        check(&boxes, 1);
        check(&boxes, 8);
    }

    #[test]
    fn the_number_of_threads_does_not_matter() {
        let boxes: Vec<_> = (0..70_000u32)
            .map(|i| point([(i * 7919 % 10_007) as f32, (i * 31 % 997) as f32, (i % 13) as f32]))
            .collect();
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| build(&boxes, &Options { bins: 16, block: 8 })).order
        };
        assert_eq!(on(1), on(3));
    }
}
