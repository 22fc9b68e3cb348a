//! Octrees: every cell is split in the middle along all three axes, so split positions need no storage.
//!
//! A node takes 4 bytes and stores neither plane nor box. Traversal tracks the `t` of a cell's six planes; that of a
//! plane between its eight children is the mean of two (Revelles, Ureña and Lastra, "An Efficient Parametric Algorithm
//! for Octree Traversal", 2000). Cells have the proportions of the scene's bounding box.
//!
//! The `t` of a plane is uncertain by an amount that is the same for all planes across an axis. Children that the ray
//! certainly misses are skipped; all others are visited.

use super::walk::{BuildBudget, Input, Lists, PartPosition, PrimitivePart, SplitPlane, Structure, Walker};
use super::{Info, NodeBox, SlabRay};
use raywright_base::math::Aabb;
use raywright_base::math::robust::{greater, lesser};
use raywright_base::parallel;
use std::array::from_fn;

/// Maximum depth. There, cells are about as small as the uncertainty of a ray's position.
pub const MAX_DEPTH: usize = 18;

/// Build options of an octree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Maximum depth, up to [`MAX_DEPTH`].
    pub max_depth: usize,
    /// Cells with at most this many primitives become leaves.
    pub leaf_size: usize,
}

impl Options {
    /// A good choice for most scenes.
    pub const DEFAULT: Self = Self { max_depth: 12, leaf_size: 8 };
}

impl Default for Options {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// An octree.
#[derive(Clone, Debug)]
pub struct Octree {
    /// The nodes, root first.
    nodes: Vec<Node>,
    /// The root's cell.
    bounds: Aabb,
    depth: usize,
    /// The surface area heuristic: one per inner node, plus the primitives of each leaf, each times the probability
    /// that a ray through the root's cell hits the cell.
    sah_cost: f64,
}

/// The index of the first of eight consecutive children, or a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Node(u32);

const _: () = assert!(size_of::<Node>() == 4);

impl Node {
    const LEAF: u32 = 1 << 31;

    /// An empty leaf.
    const EMPTY: Self = Self(u32::MAX);

    fn leaf(number: usize) -> Self {
        assert!(number < Self::LEAF as usize - 1, "an octree has at most 2^31 leaves, got {number}");
        Self(number as u32 | Self::LEAF)
    }

    fn inner(children: usize) -> Self {
        assert!(children < Self::LEAF as usize, "an octree has at most 2^31 nodes, got {children}");
        Self(children as u32)
    }

    #[inline(always)]
    fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    /// The index of a nonempty leaf.
    fn number(self) -> Option<u32> {
        (self.is_leaf() && self != Self::EMPTY).then_some(self.0 & !Self::LEAF)
    }

    /// The first child of an inner node.
    fn children(self) -> Option<usize> {
        (!self.is_leaf()).then_some(self.0 as usize)
    }
}

/// Minimum number of parts for parallel distribution, and parts per task.
const SHARE: usize = 4096;

/// Build an octree over primitives.
///
/// The result is bit-identical for any number of threads. Time is proportional to n times the number of levels, with n
/// counting clipped parts. A cell becomes a leaf if a split would not save tests, as for coincident primitives. There
/// are at most 9 times as many parts as primitives, plus 64.
///
/// # Panics
///
/// If an option is out of range.
pub fn build(input: &Input, options: &Options) -> (Box<dyn Structure>, Lists) {
    let Options { max_depth, leaf_size } = *options;
    assert!(max_depth <= MAX_DEPTH, "max_depth is {max_depth}, more than {MAX_DEPTH}");
    assert!(leaf_size > 0, "leaf_size is 0");
    let (parts, bounds) = input.parts();
    let mut tree = Octree { nodes: Vec::new(), bounds, depth: 0, sah_cost: 0.0 };
    let mut lists = Lists::default();
    if parts.is_empty() {
        return (Box::new(tree), lists);
    }
    tree.nodes.push(Node::EMPTY);
    let room = BuildBudget::new(parts.len(), max_depth);
    let mut open = vec![(OctreeCell { node: 0, aabb: bounds, at: [0; 3], depth: 0 }, parts, room)];
    let (steps, mut told) = (input.work.steps(BuildBudget::STEPS), 0);
    while let Some((cell, parts, room)) = open.pop() {
        if parts.len() > SHARE && steps.is_stopped() {
            break;
        }
        // A child has a quarter of its parent's surface area, so a quarter of its rays.
        let share = 0.25f64.powi(cell.depth as i32);
        let parted = if parts.len() > leaf_size { tree.parted(input, &cell, &parts, room) } else { None };
        let Some((children, rooms)) = parted else {
            tree.depth = tree.depth.max(cell.depth);
            told += room.steps();
            if told > BuildBudget::STEPS / 1000 && steps.did(std::mem::take(&mut told)).is_err() {
                break;
            }
            tree.sah_cost += share * parts.len() as f64;
            if !parts.is_empty() {
                tree.nodes[cell.node] = Node::leaf(lists.counts.len());
                lists.counts.push(parts.len() as u32);
                lists.order.extend(parts.iter().map(|part| part.primitive));
            }
            continue;
        };
        tree.sah_cost += share;
        let first = tree.nodes.len();
        tree.nodes[cell.node] = Node::inner(first);
        tree.nodes.extend([Node::EMPTY; 8]);
        for (octant, (parts, room)) in children.into_iter().zip(rooms).enumerate().rev() {
            open.push((tree.child(&cell, first, octant), parts, room));
        }
    }
    (Box::new(tree), lists)
}

/// A node and its cell during the build.
#[derive(Clone, Copy, Debug)]
struct OctreeCell {
    node: usize,
    aabb: Aabb,
    /// Its index among the cells of its level, by axis.
    at: [u32; 3],
    depth: usize,
}

impl Octree {
    /// The splitting plane, rounded to f32. Rays use the exact position and allow for the difference.
    fn plane(&self, cell: &OctreeCell, axis: usize) -> SplitPlane {
        let (min, max) = (f64::from(self.bounds.min[axis]), f64::from(self.bounds.max[axis]));
        let share = f64::from(2 * cell.at[axis] + 1) / f64::from(1u32 << (cell.depth + 1));
        SplitPlane { axis, at: (min + (max - min) * share) as f32 }
    }

    /// One of eight consecutive children. Bits 0 to 2 of its octant are set if it lies above the plane normal to x to
    /// z.
    fn child(&self, cell: &OctreeCell, first: usize, octant: usize) -> OctreeCell {
        let mut child = OctreeCell { node: first + octant, depth: cell.depth + 1, ..*cell };
        for axis in 0..3 {
            let side = octant >> axis & 1;
            child.aabb = self.plane(cell, axis).cut(&child.aabb)[side];
            child.at[axis] = 2 * cell.at[axis] + side as u32;
        }
        child
    }

    /// Distribute parts to the children, with their share of the budget. None if that saves no tests or exceeds the
    /// budget.
    fn parted(
        &self,
        input: &Input,
        cell: &OctreeCell,
        parts: &[PrimitivePart],
        room: BuildBudget,
    ) -> Option<([Vec<PrimitivePart>; 8], [BuildBudget; 8])> {
        if room.depth == 0 {
            return None;
        }
        let dealt = |parts: &[PrimitivePart]| {
            let mut children: [Vec<PrimitivePart>; 8] = from_fn(|_| Vec::new());
            for part in parts {
                self.deal(input, cell, *part, &mut |octant, part| children[octant].push(part));
            }
            children
        };
        let children = if parts.len() > SHARE {
            let shares = parallel::map_chunks(parts.len(), SHARE, |share| dealt(&parts[share]));
            from_fn(|octant| shares.iter().flat_map(|share| &share[octant]).copied().collect())
        } else {
            dealt(parts)
        };
        let counts = children.each_ref().map(Vec::len);
        // Each child is hit by a quarter of the rays.
        let saves = counts.iter().sum::<usize>() < 4 * parts.len();
        room.shared(parts.len(), counts).filter(|_| saves).map(|rooms| (children, rooms))
    }

    /// Clip a part to each child that it overlaps.
    fn deal(&self, input: &Input, cell: &OctreeCell, part: PrimitivePart, to: &mut impl FnMut(usize, PrimitivePart)) {
        let mut pieces = [(0, part); 8];
        let mut count = 1;
        for axis in 0..3 {
            let plane = self.plane(cell, axis);
            let before = count;
            for i in 0..before {
                let (octant, part) = pieces[i];
                let above = octant | 1 << axis;
                match part.halves(input, plane) {
                    PartPosition::Below | PartPosition::Within => {}
                    PartPosition::Above => pieces[i].0 = above,
                    PartPosition::Both(halves) => {
                        let [below_part, above_part] = halves.map(|aabb| PrimitivePart { aabb, ..part });
                        pieces[i].1 = below_part;
                        pieces[count] = (above, above_part);
                        count += 1;
                    }
                }
            }
        }
        // Empty pieces stay empty.
        for &(octant, part) in pieces[..count].iter().filter(|(_, part)| !part.aabb.is_empty()) {
            to(octant, part);
        }
    }

    /// All cells, root first.
    fn cells(&self) -> impl Iterator<Item = OctreeCell> {
        let root = OctreeCell { node: 0, aabb: self.bounds, at: [0; 3], depth: 0 };
        let mut open: Vec<_> = self.nodes.first().map(|_| root).into_iter().collect();
        std::iter::from_fn(move || {
            let cell = open.pop()?;
            if let Some(first) = self.nodes[cell.node].children() {
                open.extend((0..8).rev().map(|octant| self.child(&cell, first, octant)));
            }
            Some(cell)
        })
    }

    /// Return whether a part is in all the leaves it overlaps below a node.
    fn stands(&self, input: &Input, lists: &[Vec<u32>], cell: &OctreeCell, part: PrimitivePart) -> bool {
        match self.nodes[cell.node].children() {
            Some(first) => {
                let mut all = true;
                self.deal(input, cell, part, &mut |octant, part| {
                    all = all && self.stands(input, lists, &self.child(cell, first, octant), part);
                });
                all
            }
            None => {
                let list = self.nodes[cell.node].number().map(|leaf| &lists[leaf as usize]);
                list.is_some_and(|list| list.binary_search(&part.primitive).is_ok())
            }
        }
    }
}

impl Structure for Octree {
    fn walker(&self, counted: bool) -> Box<dyn Walker + '_> {
        // A path leaves seven siblings per level, and the root.
        let open = Vec::with_capacity(7 * self.depth + 1);
        if counted {
            Box::new(OctreeTraversal::<true> { tree: self, way: CellRay::new(&SlabRay::EVERYWHERE), open, nodes: 0 })
        } else {
            Box::new(OctreeTraversal::<false> { tree: self, way: CellRay::new(&SlabRay::EVERYWHERE), open, nodes: 0 })
        }
    }

    fn info(&self) -> Info {
        let leaves = self.cells().filter(|cell| self.nodes[cell.node].is_leaf()).count();
        Info {
            kind: "octree".into(),
            nodes: self.nodes.len() - leaves,
            leaves,
            depth: self.depth,
            bytes: size_of_val(self.nodes.as_slice()),
            sah_cost: self.sah_cost,
            ..Info::default()
        }
    }

    fn boxes(&self, primitives: &dyn Fn(u32) -> usize) -> Option<Vec<NodeBox>> {
        let of = |OctreeCell { node, aabb, depth, .. }: OctreeCell| {
            let node = self.nodes[node];
            NodeBox { aabb, depth, primitives: node.is_leaf().then(|| node.number().map_or(0, primitives)) }
        };
        Some(self.cells().map(of).collect())
    }

    fn validate(&self, input: &Input, primitives: &dyn Fn(u32) -> Vec<u32>) -> Result<(), String> {
        let (parts, bounds) = input.parts();
        if bounds != self.bounds {
            return Err(format!("the bounding box is {bounds:?}, expected {:?}", self.bounds));
        }
        let mut parents = vec![0u32; self.nodes.len()];
        for (i, node) in self.nodes.iter().enumerate() {
            let Some(first) = node.children() else { continue };
            if first <= i || first % 8 != 1 || first + 8 > self.nodes.len() {
                return Err(format!("node {i} of {} has children {first}", self.nodes.len()));
            }
            parents[first] += 1;
        }
        if let Some(i) = (1..parents.len()).step_by(8).find(|&i| parents[i] != 1) {
            return Err(format!("node {i} has {} parents", parents[i]));
        }
        let depth = self.cells().map(|cell| cell.depth).max().unwrap_or(0);
        if depth != self.depth {
            return Err(format!("depth is {depth}, not {}", self.depth));
        }
        let mut numbers: Vec<u32> = self.nodes.iter().filter_map(|node| node.number()).collect();
        numbers.sort_unstable();
        if let Some((leaf, number)) = (0..).zip(&numbers).find(|(leaf, number)| leaf != *number) {
            return Err(format!("leaf {leaf} has the number {number}"));
        }
        let mut lists: Vec<_> = numbers.iter().map(|&leaf| primitives(leaf)).collect();
        lists.iter_mut().for_each(|list| list.sort_unstable());
        let root = OctreeCell { node: 0, aabb: self.bounds, at: [0; 3], depth: 0 };
        match parts.into_iter().find(|&part| !self.stands(input, &lists, &root, part)) {
            Some(part) => Err(format!("primitive {} is missing from a leaf", part.primitive)),
            None => Ok(()),
        }
    }
}

/// A ray prepared for cell planes.
#[derive(Clone, Copy)]
struct CellRay {
    t_min: f32,
    /// The `t` of the root's planes by axis: the near plane and the far plane.
    around: [[f32; 3]; 2],
    /// By axis, the uncertainty of a plane's `t`.
    ///
    /// With v = 2⁻²⁴ and R the ray's reach, a plane is off by up to 2v from where the builder put it. A midpoint errs
    /// by at most vR more per level, the least upper bound for halving the sum of two parent errors. In all that is
    /// less than 2vR + 18 · 2/3 · vR = 14vR, in units of t times the inverse of the direction; using the middle of each
    /// `t` interval costs less than vR. Twice the pad is 16vR.
    room: [f32; 3],
    /// Bits of the axes with a negative direction: XOR maps the first octant on the ray to octant 0.
    mirror: u32,
}

impl CellRay {
    fn new(ray: &SlabRay) -> Self {
        Self {
            t_min: ray.t_min,
            around: [[0.0; 3]; 2],
            room: from_fn(|k| 0.5 * (ray.far[k] - ray.near[k]) + 2.0 * ray.pad * ray.inverse[k].abs()),
            mirror: (0..3).map(|axis| (ray.first[axis] as u32) << axis).sum(),
        }
    }

    /// Set up the planes around a box.
    fn around(ray: &SlabRay, aabb: &Aabb) -> Self {
        let planes = [aabb.min, aabb.max];
        let t = |side: usize, axis: usize| {
            let plane = planes[side ^ ray.first[axis]][axis];
            plane * ray.inverse[axis] + 0.5 * (ray.near[axis] + ray.far[axis])
        };
        Self { around: [0, 1].map(|side| from_fn(|axis| t(side, axis))), ..Self::new(ray) }
    }

    /// A conservative interval of `t` between planes.
    #[inline(always)]
    fn span(&self, [first, last]: &[[f32; 3]; 2]) -> (f32, f32) {
        let (mut enter, mut leave) = (self.t_min, f32::INFINITY);
        for axis in 0..3 {
            enter = greater(enter, first[axis] - self.room[axis]);
            leave = lesser(leave, last[axis] + self.room[axis]);
        }
        (enter, leave)
    }
}

/// A node and the `t` of its planes.
#[derive(Clone, Copy)]
struct OpenCell {
    node: Node,
    enter: f32,
    around: [[f32; 3]; 2],
}

struct OctreeTraversal<'a, const COUNTED: bool> {
    tree: &'a Octree,
    way: CellRay,
    open: Vec<OpenCell>,
    nodes: u32,
}

/// Masks of the children above the middle of each axis.
const ABOVE: [u32; 3] = [0b1010_1010, 0b1100_1100, 0b1111_0000];

impl<const COUNTED: bool> OctreeTraversal<'_, COUNTED> {
    /// Mask of the children that the ray may enter within the parent's interval, in traversal order.
    #[inline(always)]
    fn met(&self, (enter, leave): (f32, f32), middle: &[f32; 3]) -> u32 {
        let room = &self.way.room;
        let mut met = 0xff;
        for axis in 0..3 {
            let (from, until) = (middle[axis] - room[axis], middle[axis] + room[axis]);
            met &= if from > leave { !ABOVE[axis] } else { !0 };
            met &= if until < enter { ABOVE[axis] } else { !0 };
            // Before it crosses an earlier plane, the ray is not beyond this one.
            for other in (0..3).filter(|&other| other != axis) {
                let apart = from > middle[other] + room[other];
                met &= if apart { !(ABOVE[axis] & !ABOVE[other]) } else { !0 };
            }
        }
        met
    }
}

impl<const COUNTED: bool> Walker for OctreeTraversal<'_, COUNTED> {
    fn start(&mut self, ray: &SlabRay) {
        self.way = CellRay::around(ray, &self.tree.bounds);
        self.nodes = u32::from(COUNTED);
        self.open.clear();
        if let (Some(&node), true) = (self.tree.nodes.first(), ray.passes(&self.tree.bounds, f32::INFINITY).is_some()) {
            let around = self.way.around;
            self.open.push(OpenCell { node, enter: self.way.span(&around).0, around });
        }
    }

    fn next(&mut self, limit: f32) -> Option<u32> {
        while let Some(OpenCell { node, enter, around }) = self.open.pop() {
            if enter > limit {
                continue;
            }
            let Some(children) = node.children() else {
                return node.number();
            };
            if COUNTED {
                self.nodes += 1;
            }
            let [first, last] = around;
            let middle: [f32; 3] = from_fn(|axis| 0.5 * (first[axis] + last[axis]));
            let (enter, leave) = self.way.span(&around);
            let mut met = self.met((enter, lesser(leave, limit)), &middle);
            // Push the farthest first. In this numbering children increase along the ray.
            while met != 0 {
                let octant = 31 - met.leading_zeros();
                met ^= 1 << octant;
                let node = self.tree.nodes[children + (octant ^ self.way.mirror) as usize];
                if node == Node::EMPTY {
                    continue;
                }
                let is_above = |axis: usize| octant >> axis & 1 == 1;
                let first = from_fn(|axis| if is_above(axis) { middle[axis] } else { first[axis] });
                let last = from_fn(|axis| if is_above(axis) { last[axis] } else { middle[axis] });
                let around = [first, last];
                self.open.push(OpenCell { node, enter: self.way.span(&around).0, around });
            }
        }
        None
    }

    fn nodes(&self) -> u32 {
        self.nodes
    }
}
