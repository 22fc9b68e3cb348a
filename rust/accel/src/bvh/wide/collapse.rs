//! Collapse of a binary tree to a wide one of least cost, by dynamic programming (Ylitie, Karras and Laine, "Efficient
//! Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", 2017).
//!
//! For every binary node and every number i of up to N roots, the plan has the least cost of representing its
//! primitives by at most i subtrees. A single root is either a block of triangles or a wide node, whose N roots are
//! distributed to the two children. A greedy collapse leaves more slots empty.
//!
//! By the same costs, sixteen children per node would reduce the visited nodes by a quarter (5.6 instead of 7.6 on 69 k
//! triangles; four take 11.5). The number of leaves would be the same, with two and a half times the memory per node.

use super::{Child, Info, Leaves, Options, Primitives, WideBvh, WideNode};
use crate::bvh::{BinaryBvh, Node};
use raywright_base::math::{Aabb, Region};
use raywright_base::parallel;
use raywright_base::simd::Level;
use raywright_base::work::{Steps, Stopped, Work};
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

impl<const N: usize, L: Leaves<N>> WideBvh<N, L> {
    pub(super) fn collapse(
        binary: BinaryBvh,
        primitives: &dyn Primitives,
        region: &Region,
        options: &Options,
        work: Work,
    ) -> Result<Self, Stopped> {
        let [outline, last] = work.parts([1.0, 1.0]);
        let (outline, nodes) = Outline::of(&binary, options, N as u32, outline)?;
        // Leaves take the most memory of all, so free the binary tree first.
        drop(binary);
        let wide = Self::with(nodes, &outline, primitives, region, options);
        last.done();
        last.goes_on()?;
        Ok(wide)
    }

    /// Create a tree of these nodes and the triangles of its leaves.
    pub(super) fn with(
        nodes: Vec<WideNode<N>>,
        outline: &Outline<N>,
        primitives: &dyn Primitives,
        region: &Region,
        options: &Options,
    ) -> Self {
        let leaves = L::new(region, &outline.order, &outline.counts, |p| primitives.corners(p));
        let info = Info {
            primitives: outline.order.len(),
            nodes: nodes.len(),
            leaves: outline.counts.len(),
            depth: outline.depth,
            ..Info::default()
        };
        // Each level leaves at most N − 1 siblings pending.
        let mut wide = Self {
            nodes,
            leaves,
            region: *region,
            axes: None,
            stack: outline.depth * (N - 1) + 1,
            level: Level::Scalar,
            options: *options,
            in_parts: false,
            info,
        };
        wide.info.sah_cost = wide.sah_cost();
        wide
    }
}

/// Half the surface area, bounded away from zero so that the nodes of flat and pointlike trees still count.
fn area(node: &Node) -> f32 {
    node.aabb().half_area().max(f32::MIN_POSITIVE)
}

/// The optimal representations of every binary node by 1 to N roots.
struct Plan<const N: usize> {
    /// Maximum number of primitives in a leaf.
    block: u32,
    /// The choice at every inner node, indexed by its pair of children.
    choices: Vec<AtomicU32>,
}

/// The plan of a binary node.
#[derive(Clone, Copy)]
struct Planned<const N: usize> {
    /// The least cost for at most i + 1 roots, as a sum of areas.
    cost: [f32; N],
    /// The number of primitives below.
    count: u32,
    leaf: bool,
}

/// The choices at an inner node in three bits each: 32 bits, since these are the bulk of a plan's memory.
#[derive(Clone, Copy)]
struct Choice(u32);

impl Choice {
    /// Set if a single root is a block of triangles.
    const BLOCK: u32 = 1;

    /// Of `roots` ≥ 2 roots, the number that the left child gets; 0 if fewer roots are as good.
    fn left(self, roots: usize) -> usize {
        (self.0 >> (3 * roots) & 7) as usize
    }

    /// The number of the wide node's roots that the left child gets.
    fn share(self) -> usize {
        (self.0 >> 3 & 7) as usize
    }

    fn is_block(self) -> bool {
        self.0 & Self::BLOCK != 0
    }
}

impl<const N: usize> Plan<N> {
    fn new(binary: &BinaryBvh, options: &Options, block: u32, work: Work) -> Result<Self, Stopped> {
        const { assert!(2 <= N && N <= 8, "choices have three bits") };
        let mut plan = Self { block, choices: Vec::new() };
        plan.choices.resize_with(binary.nodes.len() / 2, AtomicU32::default);
        plan.plan(binary, options, 0, 0, &work.steps(binary.order.len()));
        work.goes_on()?;
        Ok(plan)
    }

    /// The choice at an inner node. Pairs of children fill the array from its second node on.
    fn at(&self, node: &Node) -> &AtomicU32 {
        &self.choices[(node.index / 2) as usize]
    }

    fn choice(&self, node: &Node) -> Choice {
        if node.is_leaf() { Choice(Choice::BLOCK) } else { Choice(self.at(node).load(Relaxed)) }
    }

    /// Plan the subtree at `node`, `depth` levels below the root. The result is arbitrary once canceled.
    fn plan(&self, binary: &BinaryBvh, options: &Options, node: usize, depth: usize, steps: &Steps) -> Planned<N> {
        /// Subtrees above this depth are planned in parallel.
        const PARALLEL: usize = 10;
        if depth == PARALLEL && steps.is_stopped() {
            return Planned { cost: [0.0; N], count: 0, leaf: true };
        }
        let node = &binary.nodes[node];
        let area = area(node);
        if node.is_leaf() {
            assert!(node.count <= self.block, "a leaf fits a block");
            return Planned { cost: [area * options.intersection_cost; N], count: node.count, leaf: true };
        }
        let below = |child| {
            let planned = self.plan(binary, options, child, depth + 1, steps);
            if depth + 1 == PARALLEL {
                // Cancellation is noticed at the next step.
                let _ = steps.did(planned.count as usize);
            }
            planned
        };
        let [left, right] = node.children();
        let (left, right) = if depth < PARALLEL {
            parallel::join(|| below(left), || below(right))
        } else {
            (below(left), below(right))
        };
        let count = left.count + right.count;
        let as_block = if count <= self.block { area * options.intersection_cost } else { f32::INFINITY };
        // Half of all nodes have two leaves below, which can be distributed in one way only.
        let (mut cost, share) = if left.leaf && right.leaf {
            ([left.cost[0] + right.cost[0]; N], [1; N])
        } else {
            shared(&left.cost, &right.cost)
        };
        let as_node = cost[N - 1] + area * options.traversal_cost;
        let mut choice = u32::from(as_block <= as_node) | share[N - 1] << 3;
        cost[0] = as_block.min(as_node);
        for i in 1..N {
            let fewer = cost[i - 1];
            choice |= if cost[i] < fewer { share[i] << (3 * (i + 1)) } else { 0 };
            cost[i] = if cost[i] < fewer { cost[i] } else { fewer };
        }
        // One task writes each entry, and ends before any is read.
        self.at(node).store(choice, Relaxed);
        Planned { cost, count, leaf: false }
    }
}

/// For 2 to N roots, at index i for i + 1: the least cost of distributing them to two children, and the number for the
/// left one; the least of equal ones. In rows of N, for vectorization.
#[inline(always)]
fn shared<const N: usize>(left: &[f32; N], right: &[f32; N]) -> ([f32; N], [u32; N]) {
    let (mut best, mut share) = ([f32::INFINITY; N], [0; N]);
    // Contains `right` shifted by any number of roots.
    let mut moved = [[f32::INFINITY; N]; 2];
    moved[1] = *right;
    let moved = moved.as_flattened();
    for k in 1..N {
        for i in 0..N {
            let cost = left[k - 1] + moved[N + i - k];
            share[i] = if cost < best[i] { k as u32 } else { share[i] };
            best[i] = if cost < best[i] { cost } else { best[i] };
        }
    }
    (best, share)
}

/// The wide tree before its nodes and leaves are created.
pub(super) struct Outline<const N: usize> {
    pub(super) nodes: Vec<NodeOutline<N>>,
    /// The primitives, leaf by leaf.
    pub(super) order: Vec<u32>,
    /// The number of primitives of each leaf.
    pub(super) counts: Vec<u32>,
    pub(super) depth: usize,
}

/// The binary nodes that become the children of a wide node.
#[derive(Clone)]
pub(super) struct NodeOutline<const N: usize> {
    roots: [u32; N],
    children: [Child; N],
}

impl<const N: usize> NodeOutline<N> {
    const EMPTY: Self = Self { roots: [0; N], children: [Child::None; N] };

    fn build(&self, binary: &BinaryBvh) -> WideNode<N> {
        let mut children = [(Aabb::EMPTY, Child::None); N];
        let mut count = 0;
        for (&root, &child) in self.roots.iter().zip(&self.children).filter(|(_, c)| **c != Child::None) {
            children[count] = (binary.nodes[root as usize].aabb(), child);
            count += 1;
        }
        WideNode::new(&children[..count])
    }
}

impl<const N: usize> Outline<N> {
    pub(super) const NOTHING: Self = Self { nodes: Vec::new(), order: Vec::new(), counts: Vec::new(), depth: 0 };

    /// Lay out the wide tree of least cost, with leaves of at most `block` primitives, and create its nodes.
    pub(super) fn of(
        binary: &BinaryBvh,
        options: &Options,
        block: u32,
        work: Work,
    ) -> Result<(Self, Vec<WideNode<N>>), Stopped> {
        if binary.nodes.is_empty() {
            return Ok((Self::NOTHING, Vec::new()));
        }
        let [plan, outline, make] = work.parts([4.0, 4.0, 1.0]);
        let plan = Plan::<N>::new(binary, options, block, plan)?;
        let outline = Self::new(binary, &plan, outline)?;
        let nodes = make.collect(outline.nodes.len(), |i| outline.nodes[i].build(binary))?;
        Ok((outline, nodes))
    }

    fn new(binary: &BinaryBvh, plan: &Plan<N>, work: Work) -> Result<Self, Stopped> {
        /// Primitives between two checks for cancellation.
        const SOME: usize = 1 << 14;
        let steps = work.steps(binary.order.len());
        let mut told = 0;
        let order = Vec::with_capacity(binary.order.len());
        let mut outline = Self { nodes: vec![NodeOutline::EMPTY], order, counts: Vec::new(), depth: 0 };
        let mut open = vec![(0, 0u32, 0)];
        while let Some((index, top, depth)) = open.pop() {
            outline.depth = outline.depth.max(depth + 1);
            if outline.order.len() - told >= SOME {
                steps.did(outline.order.len() - told)?;
                told = outline.order.len();
            }
            let mut roots = Held::<N>::new();
            if plan.choice(&binary.nodes[top as usize]).is_block() {
                // A single leaf needs a node to hold its box, so the root is always a node.
                roots.push(top);
            } else {
                plan.wide_roots(binary, top, &mut roots);
            }
            for (lane, &root) in roots.items().iter().enumerate() {
                let child = if plan.choice(&binary.nodes[root as usize]).is_block() {
                    let mut held = Held::<N>::new();
                    held.add(binary, root);
                    let first = outline.order.len() as u32;
                    outline.order.extend_from_slice(held.items());
                    outline.counts.push(held.len as u32);
                    Child::Leaf { first, count: held.len as u32 }
                } else {
                    outline.nodes.push(NodeOutline::EMPTY);
                    let below = outline.nodes.len() - 1;
                    open.push((below, root, depth + 1));
                    Child::Node(below as u32)
                };
                let node = &mut outline.nodes[index];
                (node.roots[lane], node.children[lane]) = (root, child);
            }
        }
        Ok(outline)
    }
}

impl<const N: usize> Plan<N> {
    /// Collect the roots below a wide node made of `node`.
    fn wide_roots(&self, binary: &BinaryBvh, node: u32, roots: &mut Held<N>) {
        let node = &binary.nodes[node as usize];
        let share = self.choice(node).share();
        self.gather(binary, node.index, share, roots);
        self.gather(binary, node.index + 1, N - share, roots);
    }

    /// Collect the optimal roots, at most `count`, for a binary node. The recursion ends after at most `count`
    /// distributing steps and as many that decrease `count`.
    fn gather(&self, binary: &BinaryBvh, top: u32, mut count: usize, roots: &mut Held<N>) {
        let node = &binary.nodes[top as usize];
        let choice = self.choice(node);
        while count > 1 && choice.left(count) == 0 {
            count -= 1;
        }
        if count == 1 {
            roots.push(top);
            return;
        }
        let share = choice.left(count);
        self.gather(binary, node.index, share, roots);
        self.gather(binary, node.index + 1, count - share, roots);
    }
}

/// At most N numbers, stored inline.
struct Held<const N: usize> {
    items: [u32; N],
    len: usize,
}

impl<const N: usize> Held<N> {
    fn new() -> Self {
        Self { items: [0; N], len: 0 }
    }

    fn push(&mut self, item: u32) {
        self.items[self.len] = item;
        self.len += 1;
    }

    fn items(&self) -> &[u32] {
        &self.items[..self.len]
    }

    /// Add the primitives below a binary node, without duplicates from several parts.
    fn add(&mut self, binary: &BinaryBvh, node: u32) {
        let node = &binary.nodes[node as usize];
        if node.is_leaf() {
            for &p in &binary.order[node.index as usize..(node.index + node.count) as usize] {
                if !self.items().contains(&p) {
                    self.push(p);
                }
            }
        } else {
            self.add(binary, node.index);
            self.add(binary, node.index + 1);
        }
    }
}
