//! From a binary tree to a wide one of least cost, by dynamic programming (Ylitie, Karras and Laine, "Efficient
//! Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", 2017).
//!
//! For every binary node and every number i of up to N roots, the least cost of showing its primitives to a parent as
//! at most i subtrees. A single root is either a block of triangles or a wide node whose N roots are shared out between
//! the two children. A greedy collapse leaves more of the slots empty.

use super::{Child, Info, Leaf, Options, Primitives, WideBvh, WideNode};
use crate::accel::bvh::BinaryBvh;
use crate::math::{Aabb, Region};
use crate::simd::Level;

/// The best ways to show a binary node as 1 to N roots.
#[derive(Clone, Copy)]
struct Plan<const N: usize> {
    /// Least cost for at most i + 1 roots, times the area of nothing in particular.
    cost: [f32; N],
    /// How many of i + 1 roots the left child gets; 0 where fewer roots do as well. For one root: 0 makes a block, 1 a
    /// wide node.
    left: [u8; N],
    /// How many roots of a wide node made of this one the left child gets.
    share: u8,
    /// Where the subtree's primitives start.
    first: u32,
    /// How many they are.
    count: u32,
}

impl<const N: usize, L: Leaf<N>> WideBvh<N, L> {
    pub(super) fn collapse(
        binary: &BinaryBvh,
        primitives: &dyn Primitives,
        region: &Region,
        options: &Options,
    ) -> Self {
        let plans = plan::<N>(binary, options);
        let mut wide = Self {
            nodes: Vec::new(),
            blocks: Vec::new(),
            region: *region,
            stack: 0,
            level: Level::Scalar,
            options: *options,
            info: Info { primitives: binary.order.len(), ..Info::default() },
        };
        if plans.is_empty() {
            return wide;
        }
        // A single block has no box to stand in, so the root is always a node.
        let mut roots = Vec::with_capacity(N);
        if plans[0].left[0] == 0 {
            roots.push(0);
        } else {
            wide_roots(binary, &plans, 0, &mut roots);
        }
        wide.nodes.push(WideNode::EMPTY);
        let mut open = vec![(0usize, roots, 0usize)];
        while let Some((index, roots, depth)) = open.pop() {
            wide.info.depth = wide.info.depth.max(depth + 1);
            for (lane, &root) in roots.iter().enumerate() {
                let (node, plan) = (&binary.nodes[root], &plans[root]);
                let child = if plan.left[0] == 0 {
                    let range = plan.first as usize..(plan.first + plan.count) as usize;
                    let block = L::new(region, binary.order[range].iter().map(|&p| (p, primitives.corners(p))));
                    wide.blocks.push(block);
                    Child::Block { index: wide.blocks.len() as u32 - 1, count: plan.count }
                } else {
                    let mut below = Vec::with_capacity(N);
                    wide_roots(binary, &plans, root, &mut below);
                    wide.nodes.push(WideNode::EMPTY);
                    open.push((wide.nodes.len() - 1, below, depth + 1));
                    Child::Node(wide.nodes.len() as u32 - 1)
                };
                wide.nodes[index].set(lane, &node.aabb(), child);
            }
        }
        wide.nodes.shrink_to_fit();
        wide.blocks.shrink_to_fit();
        wide.info.nodes = wide.nodes.len();
        wide.info.leaves = wide.blocks.len();
        wide.info.sah_cost = wide.sah_cost();
        // Each step down leaves at most N − 1 siblings behind.
        wide.stack = wide.info.depth * (N - 1) + 1;
        wide
    }
}

/// Half the surface, but never nothing, so that flat and pointlike trees still count their nodes.
fn area(bounds: &Aabb) -> f32 {
    bounds.half_area().max(f32::MIN_POSITIVE)
}

fn plan<const N: usize>(binary: &BinaryBvh, options: &Options) -> Vec<Plan<N>> {
    let nothing = Plan { cost: [0.0; N], left: [0; N], share: 0, first: 0, count: 0 };
    let mut plans = vec![nothing; binary.nodes.len()];
    // Children come after their parents.
    for (i, node) in binary.nodes.iter().enumerate().rev() {
        let area = area(&node.aabb());
        if node.is_leaf() {
            assert!(node.count as usize <= N, "a leaf fits a block");
            let cost = [area * options.intersection_cost; N];
            plans[i] = Plan { cost, first: node.index, count: node.count, ..nothing };
            continue;
        }
        let [left, right] = node.children().map(|c| plans[c]);
        let mut plan = Plan { first: left.first.min(right.first), count: left.count + right.count, ..nothing };
        let shared = |roots: usize| {
            (1..roots)
                .map(|k| (left.cost[k - 1] + right.cost[roots - k - 1], k as u8))
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .expect("at least two roots")
        };
        let (below, share) = shared(N);
        plan.share = share;
        let as_block = if plan.count as usize <= N { area * options.intersection_cost } else { f32::INFINITY };
        let as_node = below + area * options.traversal_cost;
        (plan.cost[0], plan.left[0]) = if as_block <= as_node { (as_block, 0) } else { (as_node, 1) };
        for roots in 2..=N {
            let (cost, k) = shared(roots);
            let fewer = plan.cost[roots - 2];
            (plan.cost[roots - 1], plan.left[roots - 1]) = if cost < fewer { (cost, k) } else { (fewer, 0) };
        }
        plans[i] = plan;
    }
    plans
}

/// The roots below a wide node made of `node`.
fn wide_roots<const N: usize>(binary: &BinaryBvh, plans: &[Plan<N>], node: usize, roots: &mut Vec<usize>) {
    let [left, right] = binary.nodes[node].children();
    let share = plans[node].share as usize;
    gather(binary, plans, left, share, roots);
    gather(binary, plans, right, N - share, roots);
}

/// The best at most `count` roots for a binary node. Recursion ends after `count` steps that share and as many that
/// lower it.
fn gather<const N: usize>(binary: &BinaryBvh, plans: &[Plan<N>], node: usize, count: usize, roots: &mut Vec<usize>) {
    let mut count = count;
    while count > 1 && plans[node].left[count - 1] == 0 {
        count -= 1;
    }
    if count == 1 {
        roots.push(node);
        return;
    }
    let [left, right] = binary.nodes[node].children();
    let share = plans[node].left[count - 1] as usize;
    gather(binary, plans, left, share, roots);
    gather(binary, plans, right, count - share, roots);
}
