//! Top-down builders of kd-trees.

mod middle_splits;
mod sah;

use super::{MAX_DEPTH, Node, Traversal};
use crate::walk::{BuildBudget, Input, Lists, PrimitivePart};
use raywright_base::math::Aabb;
use raywright_base::parallel;
use raywright_base::work::Steps;

/// How splitting planes are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Builder {
    /// The plane of least cost by the surface area heuristic (MacDonald and Booth, "Heuristics for Ray Tracing Using
    /// Space Subdivision", 1990), with a bonus for cutting off empty space. Candidates are all ends of clipped parts,
    /// in n log n time (Wald and Havran, "On Building Fast kd-Trees for Ray Tracing, and on Doing That in O(N log N)",
    /// 2006).
    #[default]
    Sah,
    /// The median of the primitives' centers, along the cell's longest axis.
    Median,
    /// The middle of the cell's longest axis.
    Middle,
    /// The median of the primitives' centers, with axes in turn (Bentley, "Multidimensional Binary Search Trees Used
    /// for Associative Searching", 1975).
    Cycle,
}

impl Builder {
    /// All builders.
    pub const ALL: [Self; 4] = [Self::Sah, Self::Median, Self::Middle, Self::Cycle];

    /// The name in options.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sah => "sah",
            Self::Median => "median",
            Self::Middle => "middle",
            Self::Cycle => "cycle",
        }
    }
}

/// Options for the build and the traversal of a kd-tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// How splitting planes are chosen.
    pub builder: Builder,
    /// The traversal algorithm.
    pub traversal: Traversal,
    /// Cost of visiting a node in the surface area heuristic; only its ratio to the next matters.
    pub traversal_cost: f32,
    /// Cost of testing a primitive.
    pub intersection_cost: f32,
    /// The fraction by which the cost of a plane with an empty side is reduced, from 0 to 1.
    pub empty_bonus: f32,
    /// Maximum depth, up to [`MAX_DEPTH`]; by default 8 + 1.3 log₂ n for n primitives.
    pub max_depth: Option<usize>,
    /// Cells with at most this many primitives become leaves.
    pub leaf_size: usize,
}

impl Options {
    /// A good choice for most scenes. Up to eight primitives are tested at once, and the main cost of a node is branch
    /// misprediction, so a primitive is comparatively cheap.
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

/// Minimum number of parts for building both sides in parallel, and for searching the axes in parallel.
const PARALLEL: usize = 4096;

/// Report the progress of a subtree, if one thread built all of it.
fn told(steps: &Steps, parts: usize, room: BuildBudget, is_all: bool) {
    if is_all && parts <= PARALLEL {
        // Cancellation is checked before nodes are created.
        let _ = steps.did(room.steps());
    }
}

/// Return whether the build is canceled. Small cells are not checked, since they build quickly.
fn is_stopped(steps: &Steps, parts: usize) -> bool {
    const FEW: usize = 256;
    parts > FEW && steps.is_stopped()
}

/// Build the nodes and leaves; return the scene's bounding box, too.
pub fn build(input: &Input, options: &Options) -> (Vec<Node>, Lists, Aabb) {
    options.check();
    let (parts, bounds) = input.parts();
    let count = parts.len();
    if count == 0 {
        return (Vec::new(), Lists::default(), bounds);
    }
    let depth = options.max_depth.unwrap_or_else(|| BuildBudget::depth_for(count).min(MAX_DEPTH));
    let room = BuildBudget::new(count, depth);
    // The root and an unused node, so that all pairs of children start at even indices.
    let mut grown = Grown { nodes: vec![Node::EMPTY; 2], lists: Lists::default() };
    let steps = input.work.steps(BuildBudget::STEPS);
    grown.nodes[0] = match options.builder {
        Builder::Sah => sah::grow(input, options, parts, bounds, room, &mut grown),
        other => middle_splits::Halving { input, builder: other, options, steps: &steps }
            .grow(parts, bounds, room, &mut grown),
    };
    let Grown { nodes, lists } = grown;
    (nodes, lists, bounds)
}

/// A growing part of the tree whose node indices start at 0.
#[derive(Default)]
struct Grown {
    nodes: Vec<Node>,
    lists: Lists,
}

impl Grown {
    /// Create a leaf.
    fn leaf(&mut self, parts: &[PrimitivePart]) -> Node {
        if parts.is_empty() {
            return Node::EMPTY;
        }
        let number = self.lists.counts.len() as u32;
        self.lists.counts.push(parts.len() as u32);
        self.lists.order.extend(parts.iter().map(|part| part.primitive));
        Node::leaf(number, parts.len())
    }

    /// Build two subtrees as adjacent children and return the index of the first; in parallel if they are large.
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
