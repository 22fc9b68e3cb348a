//! Pieces of polygons, as planes cut them.

use super::plane::{Plane, Side};
use crate::walk::Input;
use raywright_base::math::{Aabb, DVec3};

/// What does not reach over a plane by more lies on one side of it. A piece is where it should be but for less than a
/// quarter of it: a cut in f64 of coordinates up to 2 lies on the edge that it cuts, and off the plane, by less than
/// 2⁻⁴⁸ each, and no more than 60 are made.
pub const TOLERANCE: f64 = 1.0 / (1u64 << 40) as f64;

/// What of a primitive lies in a cell.
#[derive(Clone, Debug)]
pub struct Piece {
    pub primitive: u32,
    pub outline: Outline,
}

/// Where it lies, in box units.
#[derive(Clone, Debug)]
pub enum Outline {
    /// A convex polygon, of a triangle.
    Polygon(Vec<DVec3>),
    /// Somewhere in a box, from one corner to another: of what is no triangle. Only planes across axes cut it.
    Box([DVec3; 2]),
}

impl Piece {
    /// All of a primitive.
    pub fn whole(input: &Input, primitive: u32) -> Self {
        let outline = match triangle(input, primitive) {
            Some(corners) => Outline::Polygon(corners.to_vec()),
            None => {
                let Aabb { min, max } = input.boxes[primitive as usize];
                Outline::Box([min.as_dvec3(), max.as_dvec3()])
            }
        };
        Self { primitive, outline }
    }

    /// Its least and greatest height over a plane.
    pub fn range(&self, plane: &Plane) -> [f64; 2] {
        match &self.outline {
            Outline::Polygon(corners) => plane.range(corners),
            Outline::Box(corners) => plane.range_of_box(*corners),
        }
    }

    /// The box around it.
    pub fn extremes(&self) -> [DVec3; 2] {
        match &self.outline {
            Outline::Polygon(corners) => {
                let nothing = [DVec3::INFINITY, DVec3::NEG_INFINITY];
                corners.iter().fold(nothing, |[min, max], &p| [min.min(p), max.max(p)])
            }
            Outline::Box(corners) => *corners,
        }
    }

    /// What is behind a plane, and what in front of it; all of it on side `within` if it lies in the plane, for rays
    /// are on both sides of what they are so near to.
    pub fn parted(self, plane: &Plane, within: usize) -> [Option<Self>; 2] {
        match Plane::side(self.range(plane), TOLERANCE) {
            Side::Back => [Some(self), None],
            Side::Front => [None, Some(self)],
            Side::Within if within == 0 => [Some(self), None],
            Side::Within => [None, Some(self)],
            Side::Both => {
                let primitive = self.primitive;
                let halves = match self.outline {
                    Outline::Polygon(corners) => plane.cut(&corners, &mut Vec::new()).map(Outline::Polygon),
                    Outline::Box([min, max]) => {
                        let (mut below, mut above) = (max, min);
                        if let Some(axis) = plane.axis() {
                            (below[axis], above[axis]) = (plane.offset, plane.offset);
                        }
                        [Outline::Box([min, below]), Outline::Box([above, max])]
                    }
                };
                halves.map(|outline| Some(Self { primitive, outline }))
            }
        }
    }
}

/// The corners of a triangle in box units; none of what is no triangle.
pub fn triangle(input: &Input, primitive: u32) -> Option<[DVec3; 3]> {
    let corners = input.primitives.corners(primitive);
    corners.iter().all(|c| c.is_finite()).then(|| corners.map(|c| input.region.to_box(c)))
}
