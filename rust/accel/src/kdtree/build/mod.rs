//! Builders of kD-trees, all from the top down.

mod halves;
mod sah;

use super::{MAX_DEPTH, Node, Traversal};
use crate::walk::{Input, Lists, Part, Room};
use raywright_base::math::Aabb;
use raywright_base::parallel;
use raywright_base::work::Steps;

/// Ways to choose a plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Builder {
    /// Where the surface-area heuristic expects the least work (MacDonald and Booth, "Heuristics for Ray Tracing Using
    /// Space Subdivision", 1990), with a bonus for cutting off empty space, among all ends of clipped parts, in n log n
    /// (Wald and Havran, "On Building Fast kd-Trees for Ray Tracing, and on Doing That in O(N log N)", 2006).
    #[default]
    Sah,
    /// Across the cell's longest axis, at the median of the primitives' centres.
    Median,
    /// In the middle of the cell, across its longest axis.
    Middle,
    /// Across one axis after the other, at the median of the primitives' centres (Bentley, "Multidimensional Binary
    /// Search Trees Used for Associative Searching", 1975).
    Cycle,
}

impl Builder {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Sah, Self::Median, Self::Middle, Self::Cycle];

    /// As options call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sah => "sah",
            Self::Median => "median",
            Self::Middle => "middle",
            Self::Cycle => "cycle",
        }
    }
}

/// How to build a kD-tree, and how to walk it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// How a plane is chosen.
    pub builder: Builder,
    /// How rays go through the tree.
    pub traversal: Traversal,
    /// Cost of visiting a node, for the surface-area heuristic; only its ratio to the next matters.
    pub traversal_cost: f32,
    /// Cost of testing a primitive.
    pub intersection_cost: f32,
    /// By what part the cost of a plane is taken to be less that has nothing on one side, from 0 to 1.
    pub empty_bonus: f32,
    /// Most levels below the root, up to [`MAX_DEPTH`]; 8 + 1.3 log₂ n for n primitives if not given.
    pub max_depth: Option<usize>,
    /// So many primitives are not parted any more.
    pub leaf_size: usize,
}

impl Options {
    /// As good as any for most scenes. Up to eight primitives are tested at once, and what a node's plane costs most is
    /// that its outcome is guessed wrong: so a primitive is cheap beside it.
    pub const DEFAULT: Self = Self {
        builder: Builder::Sah,
        traversal: Traversal::Stack,
        traversal_cost: 1.0,
        intersection_cost: 0.1,
        empty_bonus: 0.2,
        max_depth: None,
        leaf_size: 8,
    };

    /// # Panics
    /// If one is out of range.
    fn check(&self) {
        let Self { traversal_cost, intersection_cost, empty_bonus, max_depth, leaf_size, .. } = *self;
        let is_cost = |cost: f32| cost > 0.0 && cost.is_finite();
        assert!(is_cost(traversal_cost), "traversal_cost is {traversal_cost}, not positive");
        assert!(is_cost(intersection_cost), "intersection_cost is {intersection_cost}, not positive");
        assert!((0.0..=1.0).contains(&empty_bonus), "empty_bonus is {empty_bonus}, not from 0 to 1");
        assert!(max_depth.is_none_or(|d| d <= MAX_DEPTH), "max_depth is {max_depth:?}, more than {MAX_DEPTH}");
        assert!(leaf_size > 0, "leaf_size is 0");
    }
}

impl Default for Options {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// From so many parts on, what is below and above a plane is built at once, and a plane is sought along all axes at
/// once.
const PARALLEL: usize = 4096;

/// Tells that so many parts are built, if that was one thread's work and all of it.
fn told(steps: &Steps, parts: usize, room: Room, is_all: bool) {
    if is_all && parts <= PARALLEL {
        // Whether to go on is asked before nodes are made.
        let _ = steps.did(room.steps());
    }
}

/// Whether it is time to ask whether to go on: of few parts, much is built in no time.
fn is_stopped(steps: &Steps, parts: usize) -> bool {
    const FEW: usize = 256;
    parts > FEW && steps.is_stopped()
}

/// Nodes and leaves, and the box around everything.
pub fn build(input: &Input, options: &Options) -> (Vec<Node>, Lists, Aabb) {
    options.check();
    let (parts, bounds) = input.parts();
    let count = parts.len();
    if count == 0 {
        return (Vec::new(), Lists::default(), bounds);
    }
    let depth = options.max_depth.unwrap_or_else(|| Room::depth_for(count).min(MAX_DEPTH));
    let room = Room::new(count, depth);
    // The root, and what stands beside it so that all pairs of children begin at even numbers.
    let mut grown = Grown { nodes: vec![Node::EMPTY; 2], lists: Lists::default() };
    let steps = input.work.steps(Room::STEPS);
    grown.nodes[0] = match options.builder {
        Builder::Sah => sah::grow(input, options, parts, bounds, room, &mut grown),
        other => {
            halves::Halving { input, builder: other, options, steps: &steps }.grow(parts, bounds, room, &mut grown)
        }
    };
    let Grown { nodes, lists } = grown;
    (nodes, lists, bounds)
}

/// A tree that grows: what is below some nodes, whose places are counted from the first of it.
#[derive(Default)]
struct Grown {
    nodes: Vec<Node>,
    lists: Lists,
}

impl Grown {
    /// Makes a leaf.
    fn leaf(&mut self, parts: &[Part]) -> Node {
        if parts.is_empty() {
            return Node::EMPTY;
        }
        let number = self.lists.counts.len() as u32;
        self.lists.counts.push(parts.len() as u32);
        self.lists.order.extend(parts.iter().map(|part| part.primitive));
        Node::leaf(number, parts.len())
    }

    /// Makes two children, what is below the first and then what is below the second, and gives the number of the
    /// first; both at once if they are many.
    fn pair(
        &mut self,
        many: bool,
        below: impl FnOnce(&mut Self) -> Node + Send,
        above: impl FnOnce(&mut Self) -> Node + Send,
    ) -> usize {
        let pair = self.nodes.len();
        self.nodes.extend([Node::EMPTY; 2]);
        let children = if many {
            let mut other = Self::default();
            let (below, above) = parallel::join(|| below(self), || above(&mut other));
            let (nodes, leaves) = (self.nodes.len(), self.lists.counts.len());
            self.nodes.extend(other.nodes.into_iter().map(|node| node.moved(nodes, leaves)));
            self.lists.counts.extend(other.lists.counts);
            self.lists.order.extend(other.lists.order);
            [below, above.moved(nodes, leaves)]
        } else {
            [below(self), above(self)]
        };
        self.nodes[pair..pair + 2].copy_from_slice(&children);
        pair
    }
}
