//! A light tree: selection among thousands of lights by estimated contribution.

use super::wide_bounds::{ChosenLanes, Importances, WIDTH, WideBounds, choose_children};
use super::{LightBounds, LightSampleContext};
use raywright_base::math::{DVec3, LANES, SingleLanes, VectorLanes};
use raywright_base::simd::Level;

/// A tree over lights (Conty Estevez and Kulla, 2018; with densities as in Pharr, Jakob and Humphreys, "Physically
/// Based Rendering", 4th edition, 2023, 12.6.3). Traversal selects one of up to eight children with a probability
/// proportional to their importance. The tree is built binary, and its nodes are joined.
#[derive(Debug)]
pub struct LightTree {
    nodes: Vec<Node>,
    /// For each light its node and lane, as a number.
    places: Vec<u32>,
    /// From the world to the unit of the nodes.
    scale: f64,
    level: Level,
}

/// A node with the bounds of its children.
#[derive(Clone, Debug)]
struct Node {
    bounds: WideBounds,
    /// For each child [`LEAF`] and a light, or the number of its node.
    links: [u32; WIDTH],
    /// Its own place: its parent and the lane there.
    place: u32,
}

/// A node of the binary tree.
#[derive(Clone, Copy)]
struct BinaryNode {
    bounds: LightBounds,
    /// The second child, or [`LEAF`] and a light. The first child follows.
    link: u32,
}

/// Marks the link of a leaf.
const LEAF: u32 = 1 << 31;

/// The place of the root, and of a light that is not in the tree.
const NOWHERE: u32 = u32::MAX;

/// Down to this depth nodes are split by cost; below it by median, with at most 31 levels.
const DEEPEST_SPLIT: u32 = 28;

/// More levels than a tree has.
const LEVELS: usize = 64;

/// Number of bins in the search for a split.
const SLICES: usize = 12;

/// A light to be inserted.
#[derive(Clone, Copy)]
struct Item {
    bounds: LightBounds,
    centre: DVec3,
    light: u32,
}

impl LightTree {
    /// Builds a tree over all lights with bounds and positive intensity; `None` if there is none.
    pub fn new(lights: &[Option<LightBounds>]) -> Option<Self> {
        assert!(lights.len() < LEAF as usize / WIDTH, "fewer than 2^28 lights");
        let all = || (0u32..).zip(lights).filter_map(|(light, bounds)| bounds.map(|bounds| (light, bounds)));
        let greatest = all().map(|(_, bounds)| bounds.intensity).fold(0.0, f64::max);
        // Normalized by the greatest, so that no importance overflows.
        let item = |(light, bounds): (u32, LightBounds)| {
            let bounds = LightBounds { intensity: bounds.intensity / greatest, ..bounds };
            Item { bounds, centre: bounds.centre(), light }
        };
        let mut items: Vec<Item> = all().map(item).filter(|item| item.bounds.intensity > 0.0).collect();
        if items.is_empty() {
            return None;
        }
        let mut binary = Vec::with_capacity(2 * items.len());
        let LightBounds { min, max, .. } = build(&mut items, 0, &mut binary);
        let extent = (0.5 * max - 0.5 * min).max_element();
        let scale = if extent > f64::MIN_POSITIVE { 1.0 / extent } else { 1.0 };
        let level = Level::current().unwrap_or(Level::Scalar);
        let mut tree = Self { nodes: Vec::new(), places: vec![NOWHERE; lights.len()], scale, level };
        tree.join(&binary, 0, NOWHERE);
        Some(tree)
    }

    /// Adds the node of a binary node and those below, and returns its number.
    fn join(&mut self, binary: &[BinaryNode], root: usize, place: u32) -> u32 {
        let mut children = vec![root];
        // The child over which lights differ most is replaced by its own.
        let is_inner = |&(_, child): &(usize, &usize)| binary[*child].link & LEAF == 0;
        let cost = |child: usize| binary[child].bounds.cost();
        while children.len() < WIDTH {
            let inner = children.iter().enumerate().filter(is_inner);
            let Some((at, &child)) = inner.max_by(|(_, a), (_, b)| cost(**a).total_cmp(&cost(**b))) else { break };
            children[at] = child + 1;
            children.push(binary[child].link as usize);
        }
        let here = self.nodes.len() as u32;
        let bounds = WideBounds::new(children.iter().map(|&child| &binary[child].bounds), self.scale);
        self.nodes.push(Node { bounds, links: [NOWHERE; WIDTH], place });
        for (lane, &child) in children.iter().enumerate() {
            let (link, place) = (binary[child].link, here * WIDTH as u32 + lane as u32);
            self.nodes[here as usize].links[lane] = if link & LEAF == 0 {
                self.join(binary, child, place)
            } else {
                self.places[(link & !LEAF) as usize] = place;
                link
            };
        }
        here
    }

    /// Importance of a node's children to a receiver.
    #[inline]
    fn importances(&self, node: usize, receiver: &LightSampleContext) -> Importances {
        self.nodes[node].bounds.importances(self.level, self.scale, receiver)
    }

    /// Selects a light for a receiver by a number in [0, 1); returns it with its probability. `None` if no light
    /// contributes there.
    #[inline]
    pub fn sample(&self, receiver: &LightSampleContext, mut u: f64) -> Option<(usize, f64)> {
        let (mut here, mut probability) = (0, 1.0);
        loop {
            let importances = self.importances(here, receiver);
            let (lane, share) = importances.choose(&mut u)?;
            probability *= share;
            let link = self.nodes[here].links[lane];
            if link & LEAF != 0 {
                return Some(((link & !LEAF) as usize, probability));
            }
            here = link as usize;
        }
    }

    /// [`LightTree::sample`] for sixteen receivers, whose normals are 0 if light reaches them from all directions, in
    /// trees of one node; `None` of others.
    pub(super) fn sample_lanes(
        &self,
        position: &VectorLanes,
        normal: &SingleLanes,
        u: &[f64; LANES],
    ) -> Option<[Option<(usize, f64)>; LANES]> {
        let [Node { bounds, links, .. }] = self.nodes.as_slice() else { return None };
        let count = links.iter().filter(|link| **link != NOWHERE).count();
        let mut chosen = ChosenLanes { lane: [0; LANES], share: [0.0; LANES] };
        choose_children(self.level, bounds, count, self.scale, position, normal, u, &mut chosen);
        let light = |i: usize| (links[chosen.lane[i] as usize % WIDTH] & !LEAF) as usize;
        Some(std::array::from_fn(|i| (chosen.share[i] > 0.0).then(|| (light(i), chosen.share[i]))))
    }

    /// Probability of selecting a light for a receiver.
    #[inline]
    pub fn probability(&self, light: usize, receiver: &LightSampleContext) -> f64 {
        let (mut path, mut depth, mut place) = ([0; LEVELS], 0, self.places[light]);
        while place != NOWHERE {
            (path[depth], depth) = (place, depth + 1);
            place = self.nodes[place as usize / WIDTH].place;
        }
        let mut probability = if depth > 0 { 1.0 } else { 0.0 };
        // From the root, so that the product is that of the draw.
        for &place in path[..depth].iter().rev() {
            let importances = self.importances(place as usize / WIDTH, receiver);
            probability *= importances.share(place as usize % WIDTH);
            if probability == 0.0 {
                return 0.0;
            }
        }
        probability
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.places.as_slice())
    }
}

/// Builds the binary tree of some lights at the end of `nodes`, and returns its bounds.
fn build(items: &mut [Item], depth: u32, nodes: &mut Vec<BinaryNode>) -> LightBounds {
    let here = nodes.len();
    if let [item] = items {
        nodes.push(BinaryNode { bounds: item.bounds, link: LEAF | item.light });
        return item.bounds;
    }
    let middle = split(items, depth);
    nodes.push(BinaryNode { bounds: items[0].bounds, link: 0 });
    let (first, second) = items.split_at_mut(middle);
    let first = build(first, depth + 1, nodes);
    nodes[here].link = nodes.len() as u32;
    let second = build(second, depth + 1, nodes);
    nodes[here].bounds = first.union(&second);
    nodes[here].bounds
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
