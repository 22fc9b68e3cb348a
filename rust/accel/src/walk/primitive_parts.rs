//! Parts of primitives clipped to cells: a primitive may lie on both sides of a splitting plane.

use super::Input;
use raywright_base::math::Aabb;
use raywright_shapes::triangle::clipped;

/// The part of a primitive inside a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrimitivePart {
    /// Its bounding box.
    pub aabb: Aabb,
    /// The primitive's number.
    pub primitive: u32,
}

/// The position of a part relative to a splitting plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PartPosition {
    /// Not above the plane.
    Below,
    /// Not below the plane.
    Above,
    /// In the plane: it may go to either side.
    Within,
    /// On both sides, with the clipped boxes; an empty box if one side is empty.
    Both([Aabb; 2]),
}

/// An axis-aligned splitting plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplitPlane {
    /// The axis, 0 to 2.
    pub axis: usize,
    /// Its position in box units.
    pub at: f32,
}

impl SplitPlane {
    /// Split a box into the two parts.
    pub fn cut(self, aabb: &Aabb) -> [Aabb; 2] {
        let [mut below, mut above] = [*aabb; 2];
        (below.max[self.axis], above.min[self.axis]) = (self.at, self.at);
        [below, above]
    }

    /// Return whether it is strictly inside a box.
    pub fn is_within(self, aabb: &Aabb) -> bool {
        aabb.min[self.axis] < self.at && self.at < aabb.max[self.axis]
    }
}

impl PrimitivePart {
    /// The center of its box along an axis.
    pub fn centre(&self, axis: usize) -> f32 {
        0.5 * (self.aabb.min[axis] + self.aabb.max[axis])
    }

    /// Classify the part against a plane. Triangles are clipped, for "perfect" splits (Havran, "Heuristic Ray Shooting
    /// Algorithms", 2000): a side gets the triangle only if it overlaps the cell on that side.
    ///
    /// Every point of the primitive in the part's box is in the closed half-space of one of the returned sides.
    pub fn halves(&self, input: &Input, plane: SplitPlane) -> PartPosition {
        let (least, greatest) = (self.aabb.min[plane.axis], self.aabb.max[plane.axis]);
        if least == plane.at && greatest == plane.at {
            PartPosition::Within
        } else if greatest <= plane.at {
            PartPosition::Below
        } else if least >= plane.at {
            PartPosition::Above
        } else {
            let corners = input.primitives.corners(self.primitive);
            let halves = plane.cut(&self.aabb);
            if corners.iter().all(|c| c.is_finite()) {
                let corners = corners.map(|c| input.region.to_box(c));
                PartPosition::Both(halves.map(|half| clipped(corners, &half)))
            } else {
                PartPosition::Both(halves)
            }
        }
    }
}

impl Input<'_> {
    /// All bounded primitives that can be hit, and their bounding box.
    pub fn parts(&self) -> (Vec<PrimitivePart>, Aabb) {
        let numbered = self.boxes.iter().zip(0..).filter(|(aabb, _)| !aabb.is_empty());
        let parts: Vec<_> = numbered.map(|(&aabb, primitive)| PrimitivePart { aabb, primitive }).collect();
        let bounds = parts.iter().fold(Aabb::EMPTY, |b, part| b.union(part.aabb));
        (parts, bounds)
    }
}
