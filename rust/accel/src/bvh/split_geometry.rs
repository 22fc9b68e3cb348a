//! The geometry of primitives as builders use it for splitting.

use super::build::Shapes;
use crate::Primitives;
use raywright_base::math::{Aabb, Axes, DVec3, Region, Vec3};
use raywright_shapes::triangle::clipped;

/// Primitives in box units. Primitives other than triangles are treated as filling their boxes.
pub struct Contents<'a> {
    pub primitives: &'a dyn Primitives,
    pub region: &'a Region,
    /// The tree's own axes, if they differ from the scene's.
    pub axes: Option<&'a Axes>,
    pub boxes: &'a [Aabb],
}

impl Contents<'_> {
    fn triangle(&self, primitive: u32) -> Option<[DVec3; 3]> {
        let corners = self.primitives.corners(primitive);
        corners.iter().all(|c| c.is_finite()).then(|| corners.map(|c| self.region.to_box_along(self.axes, c)))
    }
}

impl Shapes for Contents<'_> {
    fn clip(&self, primitive: u32, to: &Aabb) -> Aabb {
        match self.triangle(primitive) {
            Some(corners) => clipped(corners, to),
            None => self.boxes.get(primitive as usize).map_or(Aabb::EMPTY, |own| own.intersection(*to)),
        }
    }

    fn corners(&self, primitive: u32) -> Option<[Vec3; 3]> {
        Some(self.triangle(primitive)?.map(|c| c.as_vec3()))
    }
}
