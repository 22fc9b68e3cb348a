//! A top-down builder of BSP trees that picks the best of a few candidate planes per cell.
//!
//! Any plane may split a cell. Candidates are the planes of polygons, planes through their edges, and axis-aligned
//! planes that touch them (Ize, Wald and Parker, "Ray Tracing with the BSP Tree", 2008), for a few polygons of each
//! cell. The cost of each is first estimated from a sample of the pieces and the cell's width. For the best of them the
//! surface area on both sides is computed and all pieces are counted, cut ones on both sides. This weighs balance
//! against splits.

use super::cell::BspCell;
use super::pieces::{Piece, TOLERANCE, triangle};
use super::plane::{BspPlane, PlaneSide};
use super::{Child, MAX_DEPTH, Node, Options};
use crate::walk::{BuildBudget, Input, Lists};
use raywright_base::math::DVec3;
use raywright_base::parallel;
use raywright_base::work::Steps;

/// Number of sampled pieces for a cost estimate.
const ASKED: usize = 128;

/// Number of planes with an exact cost.
const CLOSELY: usize = 4;

/// Minimum extent of a cell on both sides of a plane, in box units.
const LEAST: f64 = 1.0 / (1u64 << 30) as f64;

/// Minimum number of pieces for a parallel build of both sides.
const PARALLEL: usize = 1024;

/// Cancellation is not checked for cells with at most this many pieces.
const FEW: usize = 64;

/// A subtree whose node indices start at 0.
#[derive(Default)]
pub struct Grown {
    pub nodes: Vec<Node>,
    pub lists: Lists,
    /// The expected cost times the root's surface area.
    pub cost: f64,
    pub depth: usize,
}

/// Build a tree over all primitives; return its root.
pub fn build(input: &Input, options: &Options) -> (Child, Grown) {
    let (parts, bounds) = input.parts();
    let pieces: Vec<_> = parts.iter().map(|part| Piece::whole(input, part.primitive)).collect();
    let depth = options.max_depth.unwrap_or_else(|| BuildBudget::depth_for(parts.len()).min(MAX_DEPTH));
    let mut grown = Grown::default();
    let room = BuildBudget::new(parts.len(), depth);
    let cell = BspCell::new(&bounds);
    let area = cell.area();
    let steps = input.work.steps(BuildBudget::STEPS);
    let root = match pieces.is_empty() {
        true => Child::EMPTY,
        false => BspBuilder { input, options, steps: &steps }.grow(pieces, &cell, 0, room, &mut grown),
    };
    grown.cost = if area > 0.0 { grown.cost / area } else { parts.len() as f64 };
    (root, grown)
}

#[derive(Clone, Copy)]
struct BspBuilder<'a> {
    input: &'a Input<'a>,
    options: &'a Options,
    steps: &'a Steps<'a>,
}

/// A plane and the two cells it creates.
struct BspSplit {
    plane: BspPlane,
    cells: [BspCell; 2],
    sides: [Vec<Piece>; 2],
    rooms: [BuildBudget; 2],
}

impl BspBuilder<'_> {
    /// Build the subtree of a cell.
    fn grow(self, pieces: Vec<Piece>, cell: &BspCell, depth: usize, room: BuildBudget, grown: &mut Grown) -> Child {
        let count = pieces.len();
        if count > FEW && self.steps.is_stopped() {
            return Child::EMPTY;
        }
        let area = cell.area();
        let split = if count > self.options.leaf_size && room.depth > 0 && area > 0.0 {
            self.split(pieces, cell, area, room)
        } else {
            Err(pieces)
        };
        let BspSplit { plane, cells, sides, rooms } = match split {
            Ok(split) => split,
            Err(pieces) => {
                grown.cost += area * count as f64;
                grown.depth = grown.depth.max(depth);
                return grown.leaf(&pieces);
            }
        };
        grown.cost += area;
        let place = grown.nodes.len();
        grown.nodes.push(Node { plane, children: [Child::EMPTY; 2] });
        let [back, front] = sides;
        let child = |pieces: Vec<Piece>, side: usize, grown: &mut Grown| {
            let few = pieces.len() <= PARALLEL;
            let child = self.grow(pieces, &cells[side], depth + 1, rooms[side], grown);
            if few && count > PARALLEL {
                // Cancellation is checked before nodes are created.
                let _ = self.steps.did(rooms[side].steps());
            }
            child
        };
        let children = if count > PARALLEL {
            let mut other = Grown::default();
            let (back, front) = parallel::join(|| child(back, 0, grown), || child(front, 1, &mut other));
            [back, grown.append(front, other)]
        } else {
            [child(back, 0, grown), child(front, 1, grown)]
        };
        grown.nodes[place].children = children;
        Child::node(place)
    }

    /// Split by the best plane; return the pieces if a leaf is cheaper.
    fn split(self, pieces: Vec<Piece>, cell: &BspCell, area: f64, room: BuildBudget) -> Result<BspSplit, Vec<Piece>> {
        let mut planes: Vec<_> =
            self.planes(&pieces).into_iter().filter_map(|p| Some((self.guess(&pieces, cell, area, &p)?, p))).collect();
        planes.sort_by(|a, b| a.0.total_cmp(&b.0));
        let as_leaf = f64::from(self.options.intersection_cost) * pieces.len() as f64;
        let mut best: Option<(f64, usize, BspPlane, [BspCell; 2])> = None;
        for (_, plane) in planes.into_iter().take(CLOSELY) {
            let cells = cell.halved(&plane);
            let shares = cells.each_ref().map(|cell| cell.area() / area);
            let (cost, within, counts) = self.best_counts(shares, counts(pieces.iter(), &plane), 1.0);
            let is_room = room.shared(pieces.len(), counts).is_some();
            if is_room && cost < as_leaf && best.as_ref().is_none_or(|b| cost < b.0) {
                best = Some((cost, within, plane, cells));
            }
        }
        let Some((_, within, plane, cells)) = best else { return Err(pieces) };
        let count = pieces.len();
        let mut sides = [Vec::new(), Vec::new()];
        for piece in pieces {
            for (side, piece) in sides.iter_mut().zip(piece.parted(&plane, within)) {
                side.extend(piece);
            }
        }
        let rooms = room.shared(count, sides.each_ref().map(Vec::len)).expect("as many as were counted");
        Ok(BspSplit { plane, cells, sides, rooms })
    }

    /// The least cost of a node. `shares` are the children's fractions of the surface area. The counts are the pieces
    /// behind, in front of, and within the plane. Also returns the side for the pieces in the plane, and the number of
    /// pieces on each side. `scale` is the weight of a piece.
    fn best_counts(self, shares: [f64; 2], [back, front, within]: [usize; 3], scale: f64) -> (f64, usize, [usize; 2]) {
        let Options { traversal_cost, intersection_cost, .. } = *self.options;
        let of_a_piece = f64::from(intersection_cost) * scale;
        let cost = |counts: [usize; 2]| {
            f64::from(traversal_cost) + of_a_piece * (shares[0] * counts[0] as f64 + shares[1] * counts[1] as f64)
        };
        let ways = [[back + within, front], [back, front + within]];
        let side = usize::from(cost(ways[1]) < cost(ways[0]));
        (cost(ways[side]), side, ways[side])
    }

    /// Estimate the cost of a plane; None if one side is empty.
    fn guess(self, pieces: &[Piece], cell: &BspCell, area: f64, plane: &BspPlane) -> Option<f64> {
        let areas = cell.guessed_areas(plane, LEAST)?;
        let step = pieces.len().div_ceil(ASKED);
        let counts = counts(pieces.iter().step_by(step), plane);
        let scale = pieces.len() as f64 / pieces.len().div_ceil(step) as f64;
        Some(self.best_counts(areas.map(|a| a / area), counts, scale).0)
    }

    /// Candidate planes.
    fn planes(self, pieces: &[Piece]) -> Vec<BspPlane> {
        let mut planes = Vec::new();
        let asked = self.options.candidates.min(pieces.len());
        for k in 0..asked {
            // Evenly spaced pieces, not starting with the first.
            let piece = &pieces[(2 * k + 1) * pieces.len() / (2 * asked)];
            if let Some([a, b, c]) = triangle(self.input, piece.primitive) {
                let normal = (b - a).cross(c - a);
                planes.extend(BspPlane::through(a, normal));
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    // Normalized first, since the product of short vectors would underflow.
                    let across = normal.normalize_or_zero().cross((to - from).normalize_or_zero());
                    planes.extend(BspPlane::through(from, across));
                }
            }
            planes.extend(across(piece.extremes()));
        }
        let nothing = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let [min, max] = pieces.iter().map(Piece::extremes).fold(nothing, |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        planes.extend(across([min, max]));
        let middle = 0.5 * (min + max);
        planes.extend((0..3).map(|axis| BspPlane::across(axis, middle[axis])));
        planes
    }
}

/// The axis-aligned planes around a box.
fn across(extremes: [DVec3; 2]) -> impl Iterator<Item = BspPlane> {
    extremes.into_iter().flat_map(|corner| (0..3).map(move |axis| BspPlane::across(axis, corner[axis])))
}

/// The numbers of pieces behind a plane, in front of it, and in it.
fn counts<'a>(pieces: impl Iterator<Item = &'a Piece>, plane: &BspPlane) -> [usize; 3] {
    let mut counts = [0; 3];
    for piece in pieces {
        match BspPlane::side(piece.range(plane), TOLERANCE) {
            PlaneSide::Back => counts[0] += 1,
            PlaneSide::Front => counts[1] += 1,
            PlaneSide::Within => counts[2] += 1,
            PlaneSide::Both => (counts[0], counts[1]) = (counts[0] + 1, counts[1] + 1),
        }
    }
    counts
}

impl Grown {
    /// Create a leaf.
    fn leaf(&mut self, pieces: &[Piece]) -> Child {
        if pieces.is_empty() {
            return Child::EMPTY;
        }
        let number = self.lists.counts.len();
        self.lists.counts.push(pieces.len() as u32);
        self.lists.order.extend(pieces.iter().map(|piece| piece.primitive));
        Child::leaf(number)
    }

    /// Append another subtree; return its root.
    fn append(&mut self, root: Child, other: Self) -> Child {
        let (nodes, leaves) = (self.nodes.len(), self.lists.counts.len());
        let moved = |node: Node| Node { children: node.children.map(|child| child.moved(nodes, leaves)), ..node };
        self.nodes.extend(other.nodes.into_iter().map(moved));
        self.lists.counts.extend(other.lists.counts);
        self.lists.order.extend(other.lists.order);
        self.cost += other.cost;
        self.depth = self.depth.max(other.depth);
        root.moved(nodes, leaves)
    }
}
