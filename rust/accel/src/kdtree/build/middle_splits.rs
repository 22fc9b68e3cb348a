//! Spatial middle and object median splits of kd-trees, without a cost model.

use super::{Builder, Grown, Node, Options, PARALLEL, is_stopped, told};
use crate::walk::{BuildBudget, Input, PartPosition, PrimitivePart, SplitPlane};
use raywright_base::math::Aabb;
use raywright_base::work::Steps;

/// The context of a build.
#[derive(Clone, Copy)]
pub struct Halving<'a> {
    pub input: &'a Input<'a>,
    pub builder: Builder,
    pub options: &'a Options,
    pub steps: &'a Steps<'a>,
}

/// The parts on each side of a plane, and their budgets.
type SplitSides = ([Vec<PrimitivePart>; 2], [BuildBudget; 2]);

impl Halving<'_> {
    /// Build the subtree of a cell; return its node.
    pub fn grow(self, parts: Vec<PrimitivePart>, cell: Aabb, room: BuildBudget, grown: &mut Grown) -> Node {
        if is_stopped(self.steps, parts.len()) {
            return Node::EMPTY;
        }
        if parts.len() <= self.options.leaf_size || room.depth == 0 {
            return grown.leaf(&parts);
        }
        let mut planes = self.axes(&cell, room).into_iter().filter_map(|axis| self.plane(&parts, &cell, axis));
        let parted = planes.find_map(|plane| self.parted(&parts, plane, room).map(|sides| (plane, sides)));
        let Some((plane, ([below, above], [below_room, above_room]))) = parted else { return grown.leaf(&parts) };
        let many = parts.len() > PARALLEL;
        drop(parts);
        let [below_cell, above_cell] = plane.cut(&cell);
        let child = |parts: Vec<PrimitivePart>, cell, room, grown: &mut Grown| {
            let count = parts.len();
            let node = self.grow(parts, cell, room, grown);
            told(self.steps, count, room, many);
            node
        };
        let pair = grown.pair(
            many,
            |grown| child(below, below_cell, below_room, grown),
            |grown| child(above, above_cell, above_room, grown),
        );
        Node::inner(plane.axis, plane.at, pair)
    }

    /// The axes in the order of preference.
    fn axes(self, cell: &Aabb, room: BuildBudget) -> [usize; 3] {
        let size = cell.max - cell.min;
        match self.builder {
            // The remaining depth decreases with each level, so the axes cycle.
            Builder::Cycle => [0, 1, 2].map(|k| (k + 3 - room.depth % 3) % 3),
            _ => {
                let mut axes = [0, 1, 2];
                axes.sort_by(|&a, &b| size[b].total_cmp(&size[a]));
                axes
            }
        }
    }

    /// The plane across an axis, if it is strictly inside the cell.
    fn plane(self, parts: &[PrimitivePart], cell: &Aabb, axis: usize) -> Option<SplitPlane> {
        let at = match self.builder {
            Builder::Middle => 0.5 * (cell.min[axis] + cell.max[axis]),
            _ => {
                let mut centres: Vec<f32> = parts.iter().map(|part| part.centre(axis)).collect();
                let middle = centres.len() / 2;
                *centres.select_nth_unstable_by(middle, f32::total_cmp).1
            }
        };
        let plane = SplitPlane { axis, at };
        plane.is_within(cell).then_some(plane)
    }

    /// Distribute the parts to both sides; None if that is no improvement, as for coincident primitives.
    fn parted(self, parts: &[PrimitivePart], plane: SplitPlane, room: BuildBudget) -> Option<SplitSides> {
        let mut sides = [Vec::new(), Vec::new()];
        for part in parts {
            match part.halves(self.input, plane) {
                PartPosition::Below => sides[0].push(*part),
                PartPosition::Above => sides[1].push(*part),
                PartPosition::Within => {
                    let fewer = usize::from(sides[1].len() < sides[0].len());
                    sides[fewer].push(*part);
                }
                PartPosition::Both(halves) => {
                    for (side, aabb) in sides.iter_mut().zip(halves) {
                        if !aabb.is_empty() {
                            side.push(PrimitivePart { aabb, ..*part });
                        }
                    }
                }
            }
        }
        let counts = [sides[0].len(), sides[1].len()];
        if counts[0] + counts[1] > parts.len() + parts.len() / 2 {
            return None;
        }
        room.shared(parts.len(), counts).map(|rooms| (sides, rooms))
    }
}
