//! Pieces of primitives cut by BSP planes.

use super::plane::{BspPlane, PlaneSide};
use crate::walk::Input;
use raywright_base::math::{Aabb, DVec3};

/// A piece that crosses a plane by at most this counts as on one side. A piece's own error is less than a quarter of
/// it. A cut in f64 of coordinates up to 2 is off the cut edge and the plane by less than 2⁻⁴⁸ each, and at most 60
/// cuts are made.
pub const TOLERANCE: f64 = 1.0 / (1u64 << 40) as f64;

/// The part of a primitive inside a cell.
#[derive(Clone, Debug)]
pub struct Piece {
    pub primitive: u32,
    pub outline: PieceExtent,
}

/// The extent of a piece in box units.
#[derive(Clone, Debug)]
pub enum PieceExtent {
    /// A convex polygon, part of a triangle.
    Polygon(Vec<DVec3>),
    /// A box, for other primitives. Only axis-aligned planes cut it.
    Box([DVec3; 2]),
}

impl Piece {
    /// A whole primitive.
    pub fn whole(input: &Input, primitive: u32) -> Self {
        let outline = match triangle(input, primitive) {
            Some(corners) => PieceExtent::Polygon(corners.to_vec()),
            None => {
                let Aabb { min, max } = input.boxes[primitive as usize];
                PieceExtent::Box([min.as_dvec3(), max.as_dvec3()])
            }
        };
        Self { primitive, outline }
    }

    /// The least and greatest height over a plane.
    pub fn range(&self, plane: &BspPlane) -> [f64; 2] {
        match &self.outline {
            PieceExtent::Polygon(corners) => plane.range(corners),
            PieceExtent::Box(corners) => plane.range_of_box(*corners),
        }
    }

    /// The bounding box.
    pub fn extremes(&self) -> [DVec3; 2] {
        match &self.outline {
            PieceExtent::Polygon(corners) => {
                let nothing = [DVec3::INFINITY, DVec3::NEG_INFINITY];
                corners.iter().fold(nothing, |[min, max], &p| [min.min(p), max.max(p)])
            }
            PieceExtent::Box(corners) => *corners,
        }
    }

    /// Split into the parts behind and in front of a plane. A piece in the plane goes to side `within`; that is correct
    /// because rays so near to the plane visit both sides.
    pub fn parted(self, plane: &BspPlane, within: usize) -> [Option<Self>; 2] {
        match BspPlane::side(self.range(plane), TOLERANCE) {
            PlaneSide::Back => [Some(self), None],
            PlaneSide::Front => [None, Some(self)],
            PlaneSide::Within if within == 0 => [Some(self), None],
            PlaneSide::Within => [None, Some(self)],
            PlaneSide::Both => {
                let primitive = self.primitive;
                let halves = match self.outline {
                    PieceExtent::Polygon(corners) => plane.cut(&corners, &mut Vec::new()).map(PieceExtent::Polygon),
                    PieceExtent::Box([min, max]) => {
                        let (mut below, mut above) = (max, min);
                        if let Some(axis) = plane.axis() {
                            (below[axis], above[axis]) = (plane.offset, plane.offset);
                        }
                        [PieceExtent::Box([min, below]), PieceExtent::Box([above, max])]
                    }
                };
                halves.map(|outline| Some(Self { primitive, outline }))
            }
        }
    }
}

/// The corners of a triangle in box units; None for other primitives.
pub fn triangle(input: &Input, primitive: u32) -> Option<[DVec3; 3]> {
    let corners = input.primitives.corners(primitive);
    corners.iter().all(|c| c.is_finite()).then(|| corners.map(|c| input.region.to_box(c)))
}
