//! Treelet restructuring (Karras and Aila, "Fast Parallel Construction of High-Quality Bounding Volume Hierarchies",
//! 2013).
//!
//! Bottom-up, each node and its largest descendants form a treelet of seven leaves. Dynamic programming over subsets of
//! the leaves finds the topology whose inner nodes have the least area. Treelets of one level are disjoint, so they are
//! processed in parallel, and the result does not depend on the number of threads.
//!
//! Subtrees that fit one block of triangles are leaves here and stay unchanged.

use super::linked_tree::{LinkedTree, Treelet};
use crate::bvh::BinaryBvh;
use crate::bvh::build::Bounds;
use raywright_base::parallel;
use raywright_base::work::{Stopped, Work};
use std::ops::Range;

/// Options of treelet restructuring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// The number of passes over the tree. Each pass considers only nodes with twice as many leaves as the one before.
    pub rounds: u32,
    /// A round that saves less than this fraction of the cost is the last.
    pub worthwhile: f32,
    /// Subtrees of up to this many primitives stay unchanged: as many as fit a block.
    pub block: usize,
}

/// Leaves of a treelet.
const LEAVES: usize = 7;

/// Optimize a tree in depth-first order, which is restored afterwards. The area of inner nodes does not increase, nor
/// does the depth beyond its initial value or about three times the logarithm of the number of primitives.
pub fn optimise(bvh: &mut BinaryBvh, options: &Options, work: Work) -> Result<(), Stopped> {
    if options.rounds == 0 || bvh.nodes.is_empty() {
        return Ok(());
    }
    // Each round considers half as many nodes as the one before.
    let steps = work.steps(2 * bvh.order.len());
    let mut tree = LinkedTree::new(bvh, options.block as u32);
    // Traversal stacks are sized by the depth, and a tree of least cost may be a chain.
    let deepest = tree.height().max(3 * bvh.order.len().ilog2() + 42);
    let worthwhile = f64::from(options.worthwhile) * tree.cost();
    let mut changed = false;
    for round in 0..options.rounds {
        let mut saved = 0.0;
        for (depth, level) in levels(&tree).iter().enumerate().rev() {
            // The nodes below have changed.
            level.iter().for_each(|seen| tree.measure(seen.node));
            let best = |place: usize| {
                if steps.is_stopped() {
                    return None;
                }
                let seen = &level[place];
                // No path becomes longer than the longest one before, or than the limit.
                let highest = seen.height.max(deepest.saturating_sub(depth as u32));
                if seen.leaves >= (LEAVES as u32) << round { best(&tree, seen.node, highest) } else { None }
            };
            let best = |some: Range<usize>| some.filter_map(best).collect::<Vec<_>>();
            let found: Vec<_> = parallel::map_chunks(level.len(), 16, best).into_iter().flatten().collect();
            for (treelet, gain) in &found {
                tree.regrow(treelet);
                saved += gain;
            }
            steps.did((level.len() * options.block) >> (2 + round))?;
        }
        changed |= saved > 0.0;
        if saved <= worthwhile {
            break;
        }
    }
    if changed {
        *bvh = tree.lay_out(bvh);
    }
    Ok(())
}

/// An inner node before any change below it.
struct NodeSnapshot {
    node: u32,
    height: u32,
    /// The number of leaves below.
    leaves: u32,
}

/// The inner nodes by depth.
fn levels(tree: &LinkedTree) -> Vec<Vec<NodeSnapshot>> {
    let has_children = |node: &u32| tree.below(*node).is_some();
    let mut levels: Vec<Vec<u32>> = vec![[0].into_iter().filter(has_children).collect()];
    while let Some(level) = levels.last().filter(|level| !level.is_empty()) {
        let below = level.iter().filter_map(|&node| tree.below(node)).flat_map(|first| [first, first + 1]);
        let below: Vec<u32> = below.filter(has_children).collect();
        levels.push(below);
    }
    let mut leaves = vec![1u32; tree.len()];
    for &node in levels.iter().rev().flatten() {
        if let Some(first) = tree.below(node) {
            leaves[node as usize] = leaves[first as usize] + leaves[first as usize + 1];
        }
    }
    let seen = |node: u32| NodeSnapshot { node, height: tree.height_of(node), leaves: leaves[node as usize] };
    levels.into_iter().map(|level| level.into_iter().map(seen).collect()).collect()
}

/// The best topology of the treelet at a node and the saved area; None if nothing is saved or its height exceeds the
/// limit.
fn best(tree: &LinkedTree, root: u32, highest: u32) -> Option<(Treelet, f64)> {
    let first = tree.below(root)?;
    let mut leaves = Vec::with_capacity(LEAVES);
    let mut pairs = Vec::with_capacity(LEAVES - 1);
    leaves.extend([first, first + 1]);
    pairs.push(first);
    let mut before = f64::from(tree.area(root));
    while leaves.len() < LEAVES {
        let inner = (0..leaves.len()).filter_map(|i| tree.below(leaves[i]).map(|first| (i, first)));
        let Some((largest, first)) = inner.max_by(|a, b| tree.area(leaves[a.0]).total_cmp(&tree.area(leaves[b.0])))
        else {
            break;
        };
        before += f64::from(tree.area(leaves[largest]));
        leaves[largest] = first;
        leaves.push(first + 1);
        pairs.push(first);
    }
    let (left, after) = divided(tree, &leaves);
    let mut treelet = Treelet { root, leaves, pairs, left: Box::new([0; 128]) };
    treelet.left.copy_from_slice(&left);
    let all = (1u32 << treelet.leaves.len()) - 1;
    let saved = before - after;
    (saved > 0.0 && height(tree, &treelet, all as u8) <= highest).then_some((treelet, saved))
}

/// For every set of leaves, the left subset of its topology of least area; and that area for the full set.
fn divided(tree: &LinkedTree, leaves: &[u32]) -> ([u8; 1 << LEAVES], f64) {
    let sets = 1usize << leaves.len();
    let mut bounds = [Bounds::EMPTY; 1 << LEAVES];
    let (mut cost, mut left) = ([0f64; 1 << LEAVES], [0; 1 << LEAVES]);
    for set in 1..sets {
        let (lowest, others) = (set & set.wrapping_neg(), set & (set - 1));
        bounds[set] = tree.bounds(leaves[lowest.trailing_zeros() as usize]).union(&bounds[others]);
        if others == 0 {
            continue;
        }
        // Each subset that contains the lowest leaf, other than the full set, once.
        let (mut least, mut best) = (f64::INFINITY, lowest);
        let mut right = others;
        while right != 0 {
            let part = set & !right;
            let sum = cost[part] + cost[right];
            if sum < least {
                (least, best) = (sum, part);
            }
            right = (right - 1) & others;
        }
        left[set] = best as u8;
        cost[set] = least + f64::from(bounds[set].half_area());
    }
    (left, cost[sets - 1])
}

/// The height of a set of leaves in a treelet.
fn height(tree: &LinkedTree, treelet: &Treelet, set: u8) -> u32 {
    if set.is_power_of_two() {
        return tree.height_of(treelet.leaves[set.trailing_zeros() as usize]);
    }
    let left = treelet.left[set as usize];
    1 + height(tree, treelet, left).max(height(tree, treelet, set & !left))
}
