//! Reinsertion of subtrees at cheaper places (Meister and Bittner, "Parallel Reinsertion for Bounding Volume Hierarchy
//! Optimization", 2018).
//!
//! The cost of a tree is the area of its inner nodes. Removing a subtree eliminates its parent and shrinks its
//! ancestors; reinserting it creates a new parent and enlarges the nodes above. In every round, branch and bound finds
//! the best place for each of the largest nodes, in parallel and in the unchanged tree. Then the moves are made by
//! decreasing gain, except those whose neighborhood an earlier move has changed. So the result does not depend on the
//! number of threads.
//!
//! Three details differ from the paper. Subtrees that fit one block of triangles are moved as a whole: a single
//! triangle that leaves a block shrinks inner nodes, but needs a block of its own, which costs more. A node without a
//! better place is skipped for some rounds, so that smaller nodes get their turn. And a search visits a bounded number
//! of nodes, which bounds the time on any input.

use super::linked_tree::{LinkedTree, Move, sibling};
use crate::bvh::BinaryBvh;
use crate::bvh::build::Bounds;
use raywright_base::parallel;
use raywright_base::work::{Stopped, Work};
use std::ops::Range;

/// Options of reinsertion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Maximum number of rounds.
    pub rounds: u32,
    /// The fraction of all subtrees searched per round, from 0 to 1.
    pub share: f32,
    /// Minimum saving of a round relative to the cost. A round that saves less is the last; if it is the first, the
    /// tree is left unchanged.
    pub worthwhile: f32,
    /// Subtrees of up to this many primitives are moved as a whole: as many as fit a block.
    pub block: usize,
}

/// Number of rounds for which a node without a better place is skipped.
const REST: u32 = 5;

/// Maximum number of visited node pairs per search; few searches come near.
const PATIENCE: u32 = 256;

/// Subtrees per parallel task.
const TOGETHER: usize = 64;

/// Optimize a tree in depth-first order, which is restored afterwards. The area of inner nodes does not increase, nor
/// does the depth beyond its initial value or about three times the logarithm of the number of primitives.
pub fn optimise(bvh: &mut BinaryBvh, options: &Options, work: Work) -> Result<(), Stopped> {
    if options.rounds == 0 || bvh.nodes.is_empty() {
        return Ok(());
    }
    let [open, improve, place] = work.parts([1.0, options.rounds as f32, 1.5]);
    let mut tree = LinkedTree::new(bvh, options.block as u32);
    // Traversal stacks are sized by the depth, and a tree of least cost may be a chain.
    let deepest = tree.height().max(3 * bvh.order.len().ilog2() + 42);
    let worthwhile = f64::from(options.worthwhile) * tree.cost();
    let batch = (tree.len() as f64 * f64::from(options.share)) as usize;
    let mut rests_until = vec![0; tree.len()];
    open.done();
    open.goes_on()?;
    let steps = improve.steps(options.rounds as usize);
    for round in 0..options.rounds {
        let seekers = largest(&tree, batch, |node| rests_until[node as usize] <= round);
        let seek = |some: Range<usize>| -> Vec<BetterPlace> {
            let mut open = Vec::new();
            let seekers = seekers[some].iter().take_while(|_| !steps.is_stopped());
            seekers.filter_map(|&node| best_place(&tree, node, &mut open)).collect()
        };
        let mut found: Vec<BetterPlace> =
            parallel::map_chunks(seekers.len(), TOGETHER, seek).into_iter().flatten().collect();
        steps.did(1)?;
        seekers.iter().for_each(|&node| rests_until[node as usize] = round + REST);
        found.iter().for_each(|found| rests_until[found.step.node as usize] = 0);
        found.sort_unstable_by(|a, b| b.saved.total_cmp(&a.saved).then(a.step.node.cmp(&b.step.node)));
        let (made, saved) = tree.apply(found.iter().map(|found| found.step));
        // Gains are estimated independently. In rare cases, moves together increase the cost.
        let harm = saved < 0.0 || tree.height() > deepest;
        if harm {
            tree.undo(&made);
        }
        if harm || made.is_empty() || saved < worthwhile {
            if round == 0 {
                return Ok(());
            }
            break;
        }
    }
    *bvh = tree.lay_out(bvh);
    place.done();
    Ok(())
}

/// About `count` of the largest nodes that satisfy `is_asked`, by index, without the root.
fn largest(tree: &LinkedTree, count: usize, is_asked: impl Fn(u32) -> bool) -> Vec<u32> {
    let nodes = || (0..).zip(tree.areas()).skip(1).filter(|&(node, _)| is_asked(node));
    // The area threshold is estimated from a sample.
    let stride = (tree.len() >> 12).max(1);
    let mut sample: Vec<f32> = nodes().step_by(stride).map(|(_, &area)| area).collect();
    let place = count / stride;
    let least = if place < sample.len() { *sample.select_nth_unstable_by(place, |a, b| b.total_cmp(a)).1 } else { 0.0 };
    nodes().filter(|&(_, &area)| area >= least).map(|(node, _)| node).collect()
}

/// A better place for a subtree.
struct BetterPlace {
    step: Move,
    /// The saved area.
    saved: f32,
}

/// The best place for a subtree, if it is better than the current one.
fn best_place(tree: &LinkedTree, node: u32, open: &mut Vec<InsertionPair>) -> Option<BetterPlace> {
    let bounds = *tree.bounds(node);
    let mut beside = sibling(node);
    let mut pivot = tree.parent(node);
    // The area saved above a place below the pivot, and the pivot's box without the subtree.
    let mut saved = tree.area(pivot);
    let mut rest = *tree.bounds(beside);
    open.clear();
    let mut search =
        ReinsertionSearch { tree, bounds, area: bounds.half_area(), best: 0.0, to: node, patience: PATIENCE, open };
    // Reinserting next to its own sibling changes nothing.
    if let Some(first) = tree.below(beside) {
        let grown = rest.union(&bounds).half_area();
        search.open.push(InsertionPair { first, saved: saved - (grown - rest.half_area()) });
        search.run();
    }
    while pivot != 0 && search.patience > 0 {
        beside = sibling(pivot);
        pivot = tree.parent(pivot);
        search.see(beside, saved);
        search.run();
        rest.grow(tree.bounds(beside));
        // As the pivot's sibling the subtree makes a node as large as the pivot was.
        let before = tree.area(pivot);
        saved += before - rest.half_area();
        search.offer(pivot, saved - before);
    }
    (search.to != node).then_some(BetterPlace { step: Move { node, to: search.to }, saved: search.best })
}

/// A branch and bound search for a place.
struct ReinsertionSearch<'a> {
    tree: &'a LinkedTree,
    /// The box of the subtree.
    bounds: Bounds,
    /// Its area.
    area: f32,
    /// The greatest saving so far, and its place.
    best: f32,
    to: u32,
    /// The remaining number of pairs to visit.
    patience: u32,
    open: &'a mut Vec<InsertionPair>,
}

/// Two children to visit.
struct InsertionPair {
    first: u32,
    /// The area saved above them.
    saved: f32,
}

impl ReinsertionSearch<'_> {
    #[inline(always)]
    fn offer(&mut self, to: u32, saved: f32) {
        if saved > self.best {
            (self.best, self.to) = (saved, to);
        }
    }

    /// Visit a place, given the area saved above it.
    #[inline(always)]
    fn see(&mut self, at: u32, saved: f32) {
        let bounds = self.tree.bounds(at);
        let grown = bounds.union(&self.bounds).half_area();
        self.offer(at, saved - grown);
        let saved = saved - (grown - bounds.half_area());
        if self.may_save(saved)
            && let Some(first) = self.tree.below(at)
        {
            self.open.push(InsertionPair { first, saved });
        }
    }

    /// Return whether there may be a better place below: the new parent is at least as large as the subtree.
    #[inline(always)]
    fn may_save(&self, saved: f32) -> bool {
        saved - self.area > self.best
    }

    /// Visit all pending pairs.
    fn run(&mut self) {
        while let Some(InsertionPair { first, saved }) = self.open.pop() {
            if self.may_save(saved) && self.patience > 0 {
                self.patience -= 1;
                self.see(first, saved);
                self.see(first + 1, saved);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::Node;
    use crate::bvh::build::{Leaves, assert_depth_first, binned};
    use proptest::prelude::*;
    use raywright_base::math::{Aabb, Vec3};
    use raywright_base::sampling::philox4x32;

    const THOROUGH: Options = Options { rounds: 10, share: 1.0, worthwhile: 0.0, block: 1 };

    /// The area of all inner nodes.
    fn cost(bvh: &BinaryBvh) -> f64 {
        bvh.nodes.iter().filter(|n| !n.is_leaf()).map(|n| f64::from(n.aabb().half_area())).sum()
    }

    /// A tree before and after, both validated.
    fn check(boxes: &[Aabb], options: &Options) -> [BinaryBvh; 2] {
        let leaves = Leaves::for_blocks(options.block);
        let before = binned::build(boxes, &binned::Options { bins: 16, leaves }, Work::UNWATCHED).unwrap();
        let mut after = before.clone();
        optimise(&mut after, options, Work::UNWATCHED).unwrap();
        after.validate(boxes).unwrap();
        assert_depth_first(&after);
        assert_eq!(after.nodes.len(), before.nodes.len());
        assert!(cost(&after) <= cost(&before) * (1.0 + 1e-6), "{} from {}", cost(&after), cost(&before));
        let limit = 3 * boxes.len().max(1).ilog2() as usize + 42;
        assert!(after.depth() <= limit.max(before.depth()), "depth {} of {}", after.depth(), boxes.len());
        [before, after]
    }

    /// Boxes in the unit cube, long along one axis.
    fn sticks(count: u32) -> Vec<Aabb> {
        let stick = |i| {
            let at = |purpose| philox4x32([i, 0, 0, 0], [purpose, 0]).map(|bits| bits as f32 / 2f32.powi(32));
            let [x, y, z, which] = at(0);
            let [length, ..] = at(1);
            let mut size = Vec3::splat(0.003);
            size[(which * 3.0) as usize] = 0.3 * length;
            Aabb { min: Vec3::new(x, y, z), max: Vec3::new(x, y, z) + size }
        };
        (0..count).map(stick).collect()
    }

    proptest! {
        #[test]
        fn trees_over_any_boxes_stay_valid_and_cost_no_more(
            corners in prop::collection::vec(
                (prop::array::uniform3(-2f32..2.0), [0f32..0.5, 0f32..2.0, 0f32..0.1]), 0..300,
            ),
            flat in any::<bool>(),
            share in 0.1f32..1.0,
            block in 1usize..9,
        ) {
            let boxes: Vec<_> = corners
                .iter()
                .map(|(p, d)| {
                    let keep = if flat { Vec3::new(1.0, 0.0, 1.0) } else { Vec3::ONE };
                    Aabb { min: Vec3::from(*p) * keep, max: (Vec3::from(*p) + Vec3::from(*d)) * keep }
                })
                .collect();
            check(&boxes, &Options { share, block, ..THOROUGH });
        }
    }

    #[test]
    fn trees_of_a_few_boxes_stay_valid() {
        let boxes = sticks(8);
        for count in 0..=8 {
            check(&boxes[..count], &THOROUGH);
            check(&vec![boxes[0]; count], &THOROUGH);
            check(&vec![Aabb::EMPTY; count], &THOROUGH);
        }
    }

    #[test]
    fn a_box_in_the_wrong_place_is_moved() {
        // Two pairs of neighbors, each separated by the root.
        let point = |x: f32| Aabb { min: Vec3::new(x, 0.0, 0.0), max: Vec3::new(x + 0.1, 1.0, 1.0) };
        let boxes = [0.0, 10.0, 0.2, 10.2].map(point);
        let node = |a: usize, b: usize| boxes[a].union(boxes[b]);
        let mut bvh = BinaryBvh {
            nodes: vec![
                Node::inner(node(0, 3), 1),
                Node::inner(node(0, 1), 3),
                Node::inner(node(2, 3), 5),
                Node::leaf(boxes[0], 0, 1),
                Node::leaf(boxes[1], 1, 1),
                Node::leaf(boxes[2], 2, 1),
                Node::leaf(boxes[3], 3, 1),
            ],
            order: vec![0, 1, 2, 3],
        };
        bvh.validate(&boxes).unwrap();
        optimise(&mut bvh, &THOROUGH, Work::UNWATCHED).unwrap();
        bvh.validate(&boxes).unwrap();
        let best = [node(0, 3), node(0, 2), node(1, 3)].iter().map(|b| f64::from(b.half_area())).sum::<f64>();
        assert!((cost(&bvh) - best).abs() < 1e-5, "{} is not {best}", cost(&bvh));
    }

    #[test]
    fn sticks_that_cross_gain_a_fifth() {
        let boxes = sticks(10_000);
        let [before, after] = check(&boxes, &THOROUGH);
        assert!(cost(&after) < 0.8 * cost(&before), "{} from {}", cost(&after), cost(&before));
        check(&boxes, &Options { share: 0.1, block: 8, ..THOROUGH });
    }

    #[test]
    fn what_shares_a_block_stays_together() {
        let boxes = sticks(3000);
        let options = Options { block: 8, ..THOROUGH };
        let [before, after] = check(&boxes, &options);
        assert_ne!(before.order, after.order);
        // The primitives of the largest subtrees of at most eight.
        let blocks = |bvh: &BinaryBvh| {
            let mut counts: Vec<u32> = bvh.nodes.iter().map(|n| n.count).collect();
            let mut firsts: Vec<u32> = bvh.nodes.iter().map(|n| n.index).collect();
            let mut blocks = Vec::new();
            for (i, node) in bvh.nodes.iter().enumerate().rev().filter(|(_, n)| !n.is_leaf()) {
                let [left, right] = node.children();
                (counts[i], firsts[i]) = (counts[left] + counts[right], firsts[left]);
                if counts[i] > 8 {
                    blocks.extend([left, right].into_iter().filter(|&child| counts[child] <= 8).map(|child| {
                        let first = firsts[child] as usize;
                        let mut block = bvh.order[first..first + counts[child] as usize].to_vec();
                        block.sort_unstable();
                        block
                    }));
                }
            }
            blocks
        };
        // Two small blocks may have become siblings and so form one.
        let after = blocks(&after);
        let whole = |block: &Vec<u32>| after.iter().any(|b| block.iter().all(|p| b.contains(p)));
        assert!(blocks(&before).iter().all(whole));
    }

    #[test]
    fn a_chain_of_scales_stays_shallow() {
        // The tree of least area would be as deep as the number of boxes.
        let boxes: Vec<_> = (0..2000).map(|i| Aabb { min: Vec3::ZERO, max: Vec3::splat(1.01f32.powi(i)) }).collect();
        check(&boxes, &Options { rounds: 50, ..THOROUGH });
    }

    #[test]
    fn a_tree_with_nothing_to_gain_is_left_as_it_is() {
        // Adjacent boxes on a grid.
        let boxes: Vec<_> = (0..4096)
            .map(|i| Vec3::new((i % 16) as f32, (i / 16 % 16) as f32, (i / 256) as f32))
            .map(|p| Aabb { min: p, max: p + Vec3::ONE })
            .collect();
        let [before, after] = check(&boxes, &Options { worthwhile: 1e-3, ..THOROUGH });
        assert_eq!(before.order, after.order);
    }

    #[test]
    fn coinciding_boxes_take_no_time() {
        let boxes = vec![Aabb { min: Vec3::ZERO, max: Vec3::ONE }; 1_000_000];
        let start = std::time::Instant::now();
        check(&boxes, &THOROUGH);
        assert!(start.elapsed().as_secs() < 30, "{:?}", start.elapsed());
    }

    #[test]
    fn the_number_of_threads_does_not_matter() {
        let boxes = sticks(20_000);
        let on = |threads| {
            let pool = raywright_base::workers::pool(Some(threads)).unwrap();
            pool.install(|| check(&boxes, &Options { share: 0.3, block: 8, ..THOROUGH }))
        };
        let [[_, one], [_, three]] = [on(1), on(3)];
        assert_eq!(one.order, three.order);
        let links = |bvh: &BinaryBvh| bvh.nodes.iter().map(|n| (n.index, n.count)).collect::<Vec<_>>();
        assert_eq!(links(&one), links(&three));
    }
}
