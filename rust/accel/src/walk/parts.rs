//! Parts of primitives, as planes across an axis make them: where space is divided and not the primitives, one may lie
//! on both sides.

use super::Input;
use raywright_base::math::Aabb;
use raywright_shapes::triangle::clipped;

/// What of a primitive lies in a box: all of it that lies in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Around the part.
    pub aabb: Aabb,
    /// The primitive's number.
    pub primitive: u32,
}

/// Where a part lies that a plane across an axis comes near.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Halves {
    /// Nowhere above the plane.
    Below,
    /// Nowhere below it.
    Above,
    /// In the plane: on either side.
    Within,
    /// On both sides, with what lies there; empty where that is nothing.
    Both([Aabb; 2]),
}

/// A plane across an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// The axis, 0 to 2.
    pub axis: usize,
    /// Where it stands, in box units.
    pub at: f32,
}

impl Plane {
    /// The two parts of a box.
    pub fn cut(self, aabb: &Aabb) -> [Aabb; 2] {
        let [mut below, mut above] = [*aabb; 2];
        (below.max[self.axis], above.min[self.axis]) = (self.at, self.at);
        [below, above]
    }

    /// Whether it has room on both sides in a box.
    pub fn is_within(self, aabb: &Aabb) -> bool {
        aabb.min[self.axis] < self.at && self.at < aabb.max[self.axis]
    }
}

impl Part {
    /// Half-way between the plane that it is met at first and the last.
    pub fn centre(&self, axis: usize) -> f32 {
        0.5 * (self.aabb.min[axis] + self.aabb.max[axis])
    }

    /// Where it lies. Triangles are clipped, which is what makes splits "perfect" (Havran, "Heuristic Ray Shooting
    /// Algorithms", 2000): a side gets the triangle only if some of it lies in the part of the box that is on that
    /// side.
    ///
    /// Whatever point of the primitive lies in the part's box lies in the closed half on one of the sides that are
    /// named.
    pub fn halves(&self, input: &Input, plane: Plane) -> Halves {
        let (least, greatest) = (self.aabb.min[plane.axis], self.aabb.max[plane.axis]);
        if least == plane.at && greatest == plane.at {
            Halves::Within
        } else if greatest <= plane.at {
            Halves::Below
        } else if least >= plane.at {
            Halves::Above
        } else {
            let corners = input.primitives.corners(self.primitive);
            let halves = plane.cut(&self.aabb);
            if corners.iter().all(|c| c.is_finite()) {
                let corners = corners.map(|c| input.region.to_box(c));
                Halves::Both(halves.map(|half| clipped(corners, &half)))
            } else {
                Halves::Both(halves)
            }
        }
    }
}

impl Input<'_> {
    /// All primitives that can be hit and end somewhere, and the box around them.
    pub fn parts(&self) -> (Vec<Part>, Aabb) {
        let numbered = self.boxes.iter().zip(0..).filter(|(aabb, _)| !aabb.is_empty());
        let parts: Vec<_> = numbered.map(|(&aabb, primitive)| Part { aabb, primitive }).collect();
        let bounds = parts.iter().fold(Aabb::EMPTY, |b, part| b.union(part.aabb));
        (parts, bounds)
    }
}
