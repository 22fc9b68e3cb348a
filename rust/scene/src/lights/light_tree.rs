//! A light tree: selection among thousands of lights by estimated contribution.

use super::{LightBounds, LightContextLanes, LightSampleContext};
use raywright_base::math::{DVec3, LANES};
use raywright_base::simd::{Level, loops};

/// A binary tree over lights (Conty Estevez and Kulla, 2018; with densities as in Pharr, Jakob and Humphreys,
/// "Physically Based Rendering", 4th edition, 2023, 12.6.3). Traversal selects one of two children with a probability
/// proportional to their importance.
#[derive(Debug)]
pub struct LightTree {
    /// Depth first: the first child of an inner node follows it.
    nodes: Vec<Node>,
    /// For each light, its path from the root: bit i is set if the path takes the second child at depth i.
    trails: Vec<u64>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: LightBounds,
    /// The second child, or [`Node::LEAF`] and a light.
    link: u32,
}

impl Node {
    const LEAF: u32 = 1 << 31;
}

/// The path of a light that is not in the tree.
const NOWHERE: u64 = u64::MAX;

/// Down to this depth nodes are split by cost; below it by median, with at most 31 levels. A path has 64 bits.
const DEEPEST_SPLIT: u32 = 28;

/// Number of bins in the search for a split.
const SLICES: usize = 12;

/// A light to be inserted.
#[derive(Clone, Copy)]
struct Item {
    bounds: LightBounds,
    centre: DVec3,
    light: u32,
}

loops! {
    /// Importance of a node to each receiver.
    fn importances(of: &LightBounds, receivers: &LightContextLanes, brings: &mut [f64; LANES]) {
        for i in 0..LANES {
            brings[i] = of.importance(&receivers.get(i));
        }
    }
}

impl LightTree {
    /// Builds a tree over all lights with bounds and positive intensity; `None` if there is none.
    pub fn new(lights: &[Option<LightBounds>]) -> Option<Self> {
        assert!(lights.len() < Node::LEAF as usize, "fewer than 2^31 lights");
        let all = || (0u32..).zip(lights).filter_map(|(light, bounds)| bounds.map(|bounds| (light, bounds)));
        let greatest = all().map(|(_, bounds)| bounds.intensity).fold(0.0, f64::max);
        // Normalised by the greatest, so that no importance overflows.
        let item = |(light, bounds): (u32, LightBounds)| {
            let bounds = LightBounds { intensity: bounds.intensity / greatest, ..bounds };
            Item { bounds, centre: bounds.centre(), light }
        };
        let mut items: Vec<Item> = all().map(item).filter(|item| item.bounds.intensity > 0.0).collect();
        if items.is_empty() {
            return None;
        }
        let mut tree = Self { nodes: Vec::with_capacity(2 * items.len()), trails: vec![NOWHERE; lights.len()] };
        tree.build(&mut items, 0, 0);
        Some(tree)
    }

    /// Builds the node of a path, and returns its bounds.
    fn build(&mut self, items: &mut [Item], trail: u64, depth: u32) -> LightBounds {
        let here = self.nodes.len();
        if let [item] = items {
            self.nodes.push(Node { bounds: item.bounds, link: Node::LEAF | item.light });
            self.trails[item.light as usize] = trail;
            return item.bounds;
        }
        let middle = split(items, depth);
        self.nodes.push(Node { bounds: items[0].bounds, link: 0 });
        let (first, second) = items.split_at_mut(middle);
        let first = self.build(first, trail, depth + 1);
        self.nodes[here].link = self.nodes.len() as u32;
        let second = self.build(second, trail | 1 << depth, depth + 1);
        self.nodes[here].bounds = first.union(&second);
        self.nodes[here].bounds
    }

    /// Selects a light for a receiver by a number in [0, 1); returns it with its probability. `None` if no light
    /// contributes there.
    #[inline]
    pub fn sample(&self, receiver: &LightSampleContext, u: f64) -> Option<(usize, f64)> {
        self.walk(u, |node| self.nodes[node].bounds.importance(receiver))
    }

    /// Selects a light for each of sixteen receivers. The importances of a small tree are computed for all lanes at
    /// once.
    pub fn sample_lanes(
        &self,
        level: Level,
        receivers: &LightContextLanes,
        u: &[f64; LANES],
        chosen: &mut [Option<(usize, f64)>; LANES],
    ) {
        /// Nodes of a tree of eight lights. In a larger tree a path visits only a small share of all nodes.
        const MOST: usize = 15;
        if self.nodes.len() > MOST {
            for lane in 0..LANES {
                chosen[lane] = self.sample(&receivers.get(lane), u[lane]);
            }
            return;
        }
        let mut brings = [[0.0; LANES]; MOST];
        // The root's importance is never used.
        for (node, brings) in self.nodes.iter().zip(&mut brings).skip(1) {
            importances(level, &node.bounds, receivers, brings);
        }
        for lane in 0..LANES {
            chosen[lane] = self.walk(u[lane], |node| brings[node][lane]);
        }
    }

    /// Descends from the root to a light, by the importance of each node.
    #[inline(always)]
    fn walk(&self, mut u: f64, importance: impl Fn(usize) -> f64) -> Option<(usize, f64)> {
        let (mut here, mut probability) = (0, 1.0);
        loop {
            let link = self.nodes[here].link;
            if link & Node::LEAF != 0 {
                return Some(((link & !Node::LEAF) as usize, probability));
            }
            let share = self.share(here, &importance)?;
            if u < share {
                (here, u, probability) = (here + 1, u / share, probability * share);
            } else {
                (here, u, probability) = (link as usize, (u - share) / (1.0 - share), probability * (1.0 - share));
            }
            // The quotient may be rounded up to 1.
            u = u.min(1.0 - f64::EPSILON / 2.0);
        }
    }

    /// Probability of selecting a light for a receiver.
    #[inline]
    pub fn probability(&self, light: usize, receiver: &LightSampleContext) -> f64 {
        let mut trail = self.trails[light];
        if trail == NOWHERE {
            return 0.0;
        }
        let (mut here, mut probability) = (0, 1.0);
        loop {
            let link = self.nodes[here].link;
            if link & Node::LEAF != 0 {
                return probability;
            }
            let importance = |node: usize| self.nodes[node].bounds.importance(receiver);
            let Some(share) = self.share(here, importance) else { return 0.0 };
            if trail & 1 == 0 {
                (here, probability) = (here + 1, probability * share);
            } else {
                (here, probability) = (link as usize, probability * (1.0 - share));
            }
            if probability == 0.0 {
                return 0.0;
            }
            trail >>= 1;
        }
    }

    /// Probability of an inner node's first child; `None` if neither child contributes.
    #[inline(always)]
    fn share(&self, node: usize, importance: impl Fn(usize) -> f64) -> Option<f64> {
        let first = importance(node + 1);
        let second = importance(self.nodes[node].link as usize);
        let sum = first + second;
        (sum > 0.0).then(|| first / sum)
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.trails.as_slice())
    }
}

/// Partitions items into two non-empty parts, and returns the start of the second.
fn split(items: &mut [Item], depth: u32) -> usize {
    let (low, high) = items.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), item| {
        (low.min(item.centre), high.max(item.centre))
    });
    let extent = high - low;
    let mut best: Option<(f64, usize, usize)> = None;
    if depth < DEEPEST_SPLIT {
        for axis in 0..3 {
            if extent[axis] > 0.0 {
                let slice = |item: &Item| slice_of(item.centre[axis], low[axis], extent[axis]);
                let Some((cost, at)) = best_slice(items, slice) else { continue };
                // Thin parts cost more, because they look compact from afar only along one axis.
                let cost = cost * extent.max_element() / extent[axis];
                if best.is_none_or(|(least, ..)| cost < least) {
                    best = Some((cost, axis, at));
                }
            }
        }
    }
    if let Some((_, axis, at)) = best {
        let mut middle = 0;
        for i in 0..items.len() {
            if slice_of(items[i].centre[axis], low[axis], extent[axis]) < at {
                items.swap(i, middle);
                middle += 1;
            }
        }
        return middle;
    }
    let middle = items.len() / 2;
    let axis = extent.max_position();
    items.select_nth_unstable_by(middle, |a, b| a.centre[axis].total_cmp(&b.centre[axis]).then(a.light.cmp(&b.light)));
    middle
}

fn slice_of(x: f64, low: f64, extent: f64) -> usize {
    (((x - low) / extent * SLICES as f64) as usize).min(SLICES - 1)
}

/// The best first bin of the second part, and its cost; `None` if all items are in one bin.
fn best_slice(items: &[Item], slice: impl Fn(&Item) -> usize) -> Option<(f64, usize)> {
    let mut slices: [Option<LightBounds>; SLICES] = [None; SLICES];
    let joined = |a: Option<LightBounds>, b: Option<LightBounds>| match (a, b) {
        (Some(a), Some(b)) => Some(a.union(&b)),
        (a, b) => a.or(b),
    };
    for item in items {
        let slice = &mut slices[slice(item)];
        *slice = joined(*slice, Some(item.bounds));
    }
    let mut after = slices;
    for i in (0..SLICES - 1).rev() {
        after[i] = joined(after[i], after[i + 1]);
    }
    let (mut before, mut best): (Option<LightBounds>, Option<(f64, usize)>) = (None, None);
    for i in 1..SLICES {
        before = joined(before, slices[i - 1]);
        if let (Some(first), Some(second)) = (before, after[i]) {
            let cost = first.cost() + second.cost();
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, i));
            }
        }
    }
    best
}
