//! BSP trees, which split space by arbitrary planes (Fuchs, Kedem and Naylor, "On Visible Surface Generation by A
//! Priori Tree Structures", 1980; for rays, Ize, Wald and Parker, "Ray Tracing with the BSP Tree", 2008).
//!
//! Rays traverse them front to back as in a kd-tree. Planes and rays are in f64. A ray counts as on both sides of a
//! plane while its distance is within its error, and a polygon that crosses a plane by less than a tolerance is stored
//! on one side only.

mod build;
mod cell;
mod pieces;
mod plane;

use super::walk::{Input, Lists, Structure, Walker};
use super::{Info, SlabRay};
use pieces::{Piece, TOLERANCE};
use plane::{BspPlane, PlaneSide};
use raywright_base::math::robust::{greater, lesser};
use raywright_base::math::{Aabb, DVec3};

/// Maximum depth that may be requested.
pub const MAX_DEPTH: usize = 60;

/// Maximum number of candidate polygons per cell.
pub const MAX_CANDIDATES: usize = 1024;

/// Build options of a BSP tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Number of polygons per cell that propose planes, from 1 to [`MAX_CANDIDATES`]. Each proposes its own plane,
    /// three through its edges and six axis-aligned ones.
    pub candidates: usize,
    /// Cost of visiting a node in the surface area heuristic; only its ratio to the next matters.
    pub traversal_cost: f32,
    /// Cost of testing a primitive.
    pub intersection_cost: f32,
    /// Maximum depth, up to [`MAX_DEPTH`]; by default 8 + 1.3 log₂ n for n primitives.
    pub max_depth: Option<usize>,
    /// Cells with at most this many primitives become leaves.
    pub leaf_size: usize,
}

impl Options {
    /// A good choice for most scenes.
    pub const DEFAULT: Self =
        Self { candidates: 4, traversal_cost: 1.0, intersection_cost: 1.0, max_depth: None, leaf_size: 2 };

    /// # Panics
    /// If one is out of range.
    fn check(&self) {
        let Self { candidates, traversal_cost, intersection_cost, max_depth, leaf_size } = *self;
        let is_cost = |cost: f32| cost > 0.0 && cost.is_finite();
        assert!((1..=MAX_CANDIDATES).contains(&candidates), "candidates is {candidates}, not 1 to {MAX_CANDIDATES}");
        assert!(is_cost(traversal_cost), "traversal_cost is {traversal_cost}, not positive");
        assert!(is_cost(intersection_cost), "intersection_cost is {intersection_cost}, not positive");
        assert!(max_depth.is_none_or(|d| d <= MAX_DEPTH), "max_depth is {max_depth:?}, more than {MAX_DEPTH}");
        assert!(leaf_size > 0, "leaf_size is 0");
    }
}

impl Default for Options {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// A plane and the children behind and in front of it.
#[derive(Clone, Copy, Debug)]
struct Node {
    plane: BspPlane,
    children: [Child; 2],
}

const _: () = assert!(size_of::<Node>() == 40);

/// A node or a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Child(u32);

impl Child {
    const LEAF: u32 = 1 << 31;

    /// An empty leaf.
    const EMPTY: Self = Self(u32::MAX);

    fn node(number: usize) -> Self {
        assert!(number < Self::LEAF as usize, "a BSP tree has at most 2^31 nodes, got {number}");
        Self(number as u32)
    }

    fn leaf(number: usize) -> Self {
        assert!(number < Self::LEAF as usize - 1, "a BSP tree has at most 2^31 leaves, got {number}");
        Self(number as u32 | Self::LEAF)
    }

    #[inline(always)]
    fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    /// The index of a nonempty leaf.
    fn number(self) -> Option<u32> {
        (self.is_leaf() && self != Self::EMPTY).then_some(self.0 & !Self::LEAF)
    }

    /// The same child after shifting all node and leaf indices.
    fn moved(self, nodes: usize, leaves: usize) -> Self {
        match self {
            Self::EMPTY => self,
            leaf if leaf.is_leaf() => Self(leaf.0 + leaves as u32),
            Self(node) => Self(node + nodes as u32),
        }
    }
}

/// A BSP tree.
#[derive(Clone, Debug)]
struct Bsp {
    /// Children follow their parent.
    nodes: Vec<Node>,
    root: Child,
    /// The root's cell.
    bounds: Aabb,
    depth: usize,
    /// The surface area heuristic: one plane test per inner node, plus the primitives of each leaf, each times the
    /// probability that a ray through the scene's box hits the cell.
    sah_cost: f64,
}

/// Build a BSP tree over primitives.
///
/// The result is bit-identical for any number of threads. Time is proportional to n times the number of levels, with n
/// counting cut pieces. There are at most 9 times as many pieces as primitives, plus 64. Primitives other than
/// triangles propose axis-aligned planes only, and are cut by no others.
///
/// # Panics
///
/// If an option is out of range.
pub fn build(input: &Input, options: &Options) -> (Box<dyn Structure>, Lists) {
    options.check();
    let (root, build::Grown { nodes, lists, cost, depth }) = build::build(input, options);
    let (_, bounds) = input.parts();
    (Box::new(Bsp { nodes, root, bounds, depth, sah_cost: cost }), lists)
}

impl Bsp {
    /// Return whether a piece is in all the leaves it overlaps below a node.
    fn stands(&self, lists: &[Vec<u32>], child: Child, piece: Piece) -> bool {
        if child.is_leaf() {
            let list = child.number().map(|leaf| &lists[leaf as usize]);
            return list.is_some_and(|list| list.binary_search(&piece.primitive).is_ok());
        }
        let Node { plane, children } = self.nodes[child.0 as usize];
        let on = |within| {
            let mut sides = children.into_iter().zip(piece.clone().parted(&plane, within));
            sides.all(|(child, piece)| piece.is_none_or(|piece| self.stands(lists, child, piece)))
        };
        // A piece in the plane may be on either side.
        on(0) || (BspPlane::side(piece.range(&plane), TOLERANCE) == PlaneSide::Within && on(1))
    }
}

impl Structure for Bsp {
    fn walker(&self, counted: bool) -> Box<dyn Walker + '_> {
        if counted { Box::new(BspTraversal::<true>::new(self)) } else { Box::new(BspTraversal::<false>::new(self)) }
    }

    fn info(&self) -> Info {
        Info {
            kind: "BSP tree".into(),
            nodes: self.nodes.len(),
            leaves: if self.bounds.is_empty() { 0 } else { self.nodes.len() + 1 },
            depth: self.depth,
            bytes: size_of_val(self.nodes.as_slice()),
            sah_cost: self.sah_cost,
            ..Info::default()
        }
    }

    fn validate(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<(), String> {
        let (parts, bounds) = input.parts();
        if bounds != self.bounds {
            return Err(format!("the bounding box is {bounds:?}, expected {:?}", self.bounds));
        }
        let mut depths = vec![None; self.nodes.len()];
        let mut numbers = Vec::new();
        let mut deepest = 0;
        let mut open = vec![(self.root, 0, 0)];
        while let Some((child, depth, least)) = open.pop() {
            deepest = deepest.max(depth);
            if child.is_leaf() {
                numbers.extend(child.number());
                continue;
            }
            let i = child.0 as usize;
            if i < least || i >= self.nodes.len() || depths[i].replace(depth).is_some() {
                return Err(format!("node {i} of {} has a parent behind it, or two parents", self.nodes.len()));
            }
            let Node { plane: BspPlane { normal, offset }, children } = self.nodes[i];
            if (normal.abs().element_sum() - 1.0).abs() > 1e-12 || !offset.is_finite() {
                return Err(format!("node {i} has the plane {normal} · p = {offset}"));
            }
            open.extend(children.map(|child| (child, depth + 1, i + 1)));
        }
        if let Some(i) = depths.iter().position(Option::is_none) {
            return Err(format!("node {i} has no parent"));
        }
        if deepest != self.depth {
            return Err(format!("depth is {deepest}, not {}", self.depth));
        }
        numbers.sort_unstable();
        if let Some((leaf, number)) = (0..).zip(&numbers).find(|(leaf, number)| leaf != *number) {
            return Err(format!("leaf {leaf} has the number {number}"));
        }
        let mut lists: Vec<_> = numbers.iter().map(|&leaf| primitives(leaf)).collect();
        lists.iter_mut().for_each(|list| list.sort_unstable());
        let missing = |p: &u32| !self.stands(&lists, self.root, Piece::whole(input, *p));
        match parts.into_iter().map(|part| part.primitive).find(missing) {
            Some(p) => Err(format!("primitive {p} is missing from a leaf")),
            None => Ok(()),
        }
    }
}

/// A path leaves one pending node per level. A power of two, so that masked indices need no bounds check.
const STACK: usize = 64;

const _: () = assert!(MAX_DEPTH < STACK);

/// A node or leaf, and the interval in which the ray may be inside.
#[derive(Clone, Copy)]
struct StackEntry {
    child: Child,
    enter: f64,
    leave: f64,
}

struct BspTraversal<'a, const COUNTED: bool> {
    tree: &'a Bsp,
    origin: DVec3,
    direction: DVec3,
    /// Maximum error of the ray's position, and maximum extent of a primitive across a plane for storing it on one
    /// side. It applies to each coordinate, and so to the height over any plane.
    ///
    /// The origin is rounded to f32, the inverse of the direction twice. With R the ray's reach, that moves it by less
    /// than 3 · 2⁻²⁴ R within the scene, and the pad is more than twice as much. Divisions in f64 add a negligible
    /// amount.
    room: f64,
    open: [StackEntry; STACK],
    /// Height of the stack.
    height: usize,
    nodes: u32,
}

impl<'a, const COUNTED: bool> BspTraversal<'a, COUNTED> {
    fn new(tree: &'a Bsp) -> Self {
        let open = [StackEntry { child: Child::EMPTY, enter: 0.0, leave: 0.0 }; STACK];
        Self { tree, origin: DVec3::ZERO, direction: DVec3::ONE, room: 0.0, open, height: 0, nodes: 0 }
    }
}

impl<const COUNTED: bool> Walker for BspTraversal<'_, COUNTED> {
    fn start(&mut self, ray: &SlabRay) {
        self.origin = DVec3::from_array(ray.origin.map(f64::from));
        self.direction = DVec3::from_array(ray.inverse.map(|inverse| 1.0 / f64::from(inverse)));
        self.room = f64::from(ray.pad) + 2.0 * TOLERANCE;
        self.height = 0;
        self.nodes = u32::from(COUNTED);
        if let Some((enter, leave)) = ray.passes(&self.tree.bounds, f32::INFINITY) {
            self.open[0] = StackEntry { child: self.tree.root, enter: enter.into(), leave: leave.into() };
            self.height = 1;
        }
    }

    fn next(&mut self, limit: f32) -> Option<u32> {
        let nodes = self.tree.nodes.as_slice();
        let limit = f64::from(limit);
        let mut height = self.height;
        while height > 0 {
            height -= 1;
            let StackEntry { mut child, enter, leave } = self.open[height % STACK];
            if enter > limit {
                continue;
            }
            let mut leave = lesser(leave, limit);
            while !child.is_leaf() {
                if COUNTED {
                    self.nodes += 1;
                }
                let node = &nodes[child.0 as usize];
                let (above, ascent) = (node.plane.height(self.origin), node.plane.normal.dot(self.direction));
                // An ascending ray comes from behind. NaN, from a ray along the plane at the error distance, fails both
                // comparisons, so both sides are visited.
                let up = ascent > 0.0;
                let (way, speed) = (if up { -above } else { above }, ascent.abs());
                let (from, until) = ((way - self.room) / speed, (way + self.room) / speed);
                let [first, other] = if up { node.children } else { [node.children[1], node.children[0]] };
                child = first;
                if from > leave {
                    continue;
                }
                if until < enter {
                    child = other;
                    continue;
                }
                self.open[height % STACK] = StackEntry { child: other, enter: greater(from, enter), leave };
                height += 1;
                leave = lesser(until, leave);
            }
            if let Some(leaf) = child.number() {
                self.height = height;
                return Some(leaf);
            }
        }
        self.height = 0;
        None
    }

    fn nodes(&self) -> u32 {
        self.nodes
    }
}
