//! A parallel top-down builder with the surface area heuristic on bins.
//!
//! A tree that will be collapsed is split down to a few primitives per leaf. The final leaf size is decided in the
//! collapse, where the costs of triangle blocks and wide nodes are known.

use super::bins::{Bins, Split};
use super::reference::{Bounds, Extents, MANY, Reference, median, partition, references};
use super::subtree::Subtree;
use super::top_down::{Due, TASK};
use super::{BinaryBvh, Leaves, Node, spare};
use raywright_base::math::Aabb;
use raywright_base::parallel;
use raywright_base::work::{Stopped, Work};
use std::borrow::Cow;

pub use super::bins::MAX_BINS;

/// Build options.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Bins per axis, from 2 to [`MAX_BINS`].
    pub bins: usize,
    /// When a leaf is made. Splits of sets that fit a block hardly matter, and are decided quickly.
    pub leaves: Leaves,
}

/// Build a tree over boxes, skipping empty ones.
///
/// Time is n log n on any input: splits without progress by area are replaced by median splits, and so are all splits
/// beyond a depth that no reasonable tree reaches.
///
/// # Panics
///
/// If an option is out of range.
pub fn build<'a>(boxes: impl Into<Cow<'a, [Aabb]>>, options: &Options, work: Work) -> Result<BinaryBvh, Stopped> {
    let Options { bins, leaves } = *options;
    assert!((2..=MAX_BINS).contains(&bins), "bins is {bins}, not from 2 to {MAX_BINS}");
    leaves.check();
    let [gather, grow, list, place] = work.parts([2.0, 36.0, 2.0, 6.0]);
    let mut references = references(boxes, gather)?;
    if references.is_empty() {
        return Ok(BinaryBvh::default());
    }
    let count = references.len();
    let steps = Due::steps(count, grow);
    let task = Task { bins, leaves, spare: spare(count), first: Some(0) };
    let extents = Extents::around_many(&references);
    let part = task.build(&mut references, extents, Due::all(count, &steps))?;
    let order = list.collect(count, |i| references[i].primitive())?;
    drop(references);
    part.assemble(order, place)
}

/// The parameters for building a subtree from a slice of references.
#[derive(Clone, Copy)]
pub struct Task {
    /// Bins per axis.
    pub bins: usize,
    /// When a leaf is made.
    pub leaves: Leaves,
    /// The remaining number of levels with splits by area.
    pub spare: usize,
    /// The index of the first primitive in the order; None if parts list their own.
    pub first: Option<u32>,
}

impl Task {
    /// Build a subtree.
    pub fn build(self, references: &mut [Reference], extents: Extents, due: Due) -> Result<Subtree, Stopped> {
        if references.len() <= TASK {
            let part = self.build_alone(references, extents);
            due.tell()?;
            return Ok(part);
        }
        let by_area = if self.spare == 0 {
            None
        } else if references.len() < MANY {
            Split::best(references, &extents, self.bins, &mut Bins::new())
        } else {
            Split::best_of_many(references, &extents, self.bins)
        };
        let middle = match by_area {
            Some(split) => partition(references, |r| split.is_left(r)),
            None => median(references, &extents.centres),
        };
        let (left, right) = references.split_at_mut(middle);
        let [of_left, of_right] = due.split([left.len(), right.len()])?;
        let left_task = Self { spare: self.spare.saturating_sub(1), ..self };
        let right_task = Self { first: self.first.map(|first| first + middle as u32), ..left_task };
        let (left, right) = parallel::join(
            || left_task.build(left, Extents::around_many(left), of_left),
            || right_task.build(right, Extents::around_many(right), of_right),
        );
        Ok(Subtree::pair(extents.all.aabb(), left?, right?))
    }

    /// Build a subtree on this thread.
    pub fn build_alone(self, references: &mut [Reference], extents: Extents) -> Subtree {
        /// A pending node.
        struct PendingNode {
            /// Its index below the root; None for the root.
            node: Option<usize>,
            start: usize,
            end: usize,
            extents: Extents,
            spare: usize,
        }
        let nothing = Node::leaf(Aabb::EMPTY, 0, 0);
        let (mut root, mut below) = (nothing, Vec::with_capacity(references.len()));
        let first = self.first.unwrap_or(0);
        let mut bins = Bins::new();
        let mut open = vec![PendingNode { node: None, start: 0, end: references.len(), extents, spare: self.spare }];
        while let Some(PendingNode { node, start, end, extents, spare }) = open.pop() {
            let own = &mut references[start..end];
            let aabb = extents.all.aabb();
            let split = self.split(own, &extents, spare, &mut bins);
            let child = below.len();
            let made = match split {
                Some(_) => Node::inner(aabb, child as u32),
                None => Node::leaf(aabb, first + start as u32, own.len() as u32),
            };
            *node.map_or(&mut root, |node| &mut below[node]) = made;
            let Some((middle, [left, right])) = split else { continue };
            let (middle, spare) = (start + middle, spare.saturating_sub(1));
            below.extend([nothing; 2]);
            // The stack is popped from the end, so the left subtree comes first.
            open.push(PendingNode { node: Some(child + 1), start: middle, end, extents: right, spare });
            open.push(PendingNode { node: Some(child), start, end: middle, extents: left, spare });
        }
        let order =
            if self.first.is_none() { references.iter().map(Reference::primitive).collect() } else { Vec::new() };
        Subtree::Whole { root, below, order }
    }

    /// Split references unless they become a leaf; return the number on the left and the extents of both sides.
    #[inline(always)]
    fn split(
        &self,
        own: &mut [Reference],
        extents: &Extents,
        spare: usize,
        bins: &mut Bins,
    ) -> Option<(usize, [Extents; 2])> {
        if own.len() <= self.leaves.whole {
            return None;
        }
        let middle = if own.len() <= self.leaves.block.max(2) {
            sweep(own, extents.centres.longest())
        } else {
            let by_area = if spare > 0 { Split::best(own, extents, self.bins, bins) } else { None };
            match by_area {
                Some(split) => partition(own, |r| split.is_left(r)),
                None => median(own, &extents.centres),
            }
        };
        let (left, right) = own.split_at(middle);
        let sides = [left, right].map(Extents::around);
        let [l, r] = sides.map(|side| side.all.half_area());
        let is_leaf = self.leaves.is_leaf((own.len(), extents.all.half_area()), [(left.len(), l), (right.len(), r)]);
        (!is_leaf).then_some((middle, sides))
    }
}

/// Sort at most [`Leaves::MAX_BLOCK`] references along an axis, and return the best split position by the surface area
/// heuristic.
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
    let mut right = [0.0; Leaves::MAX_BLOCK];
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::build::assert_depth_first;
    use glam::Vec3;
    use proptest::prelude::*;

    fn check(boxes: &[Aabb], block: usize) -> BinaryBvh {
        let options = Options { bins: 16, leaves: Leaves::for_blocks(block) };
        let bvh = build(boxes, &options, Work::UNWATCHED).unwrap();
        bvh.validate(boxes).unwrap();
        let n = boxes.iter().filter(|b| !b.is_empty()).count();
        assert_eq!(bvh.order.len(), n);
        let limit = if n > 0 { 3 * n.ilog2() as usize + 42 + block } else { 0 };
        assert!(bvh.depth() <= limit, "depth {} for {n} boxes", bvh.depth());
        assert!(bvh.nodes.iter().all(|n| n.count as usize <= Leaves::for_blocks(block).whole));
        assert_depth_first(&bvh);
        bvh
    }

    fn point(p: [f32; 3]) -> Aabb {
        Aabb::around([Vec3::from(p)])
    }

    proptest! {
        #[test]
        fn trees_over_any_boxes_are_valid(
            corners in prop::collection::vec(
                (prop::array::uniform3(-2f32..2.0), prop::array::uniform3(0f32..0.5)), 0..300,
            ),
            block in 1..=Leaves::MAX_BLOCK,
        ) {
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
        // A plane in the gap cuts no box, and both sides are smallest.
        let boxes: Vec<_> =
            (0..300).map(|i| point([if i % 3 == 0 { 9.0 } else { 0.0 } + 1e-3 * i as f32, 0.0, 0.5])).collect();
        let bvh = check(&boxes, 8);
        let [left, right] = bvh.nodes[0].children().map(|child| bvh.nodes[child].aabb());
        assert!(left.max.x < 1.0 && right.min.x >= 9.0);
    }

    #[test]
    fn a_staircase_of_scales_stays_shallow() {
        // Each box contains all previous ones, and equal bins can separate only one at a time.
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
            let pool = raywright_base::workers::pool(Some(threads)).unwrap();
            let options = Options { bins: 16, leaves: Leaves::for_blocks(8) };
            pool.install(|| build(&boxes, &options, Work::UNWATCHED)).unwrap().order
        };
        assert_eq!(on(1), on(3));
    }
}
