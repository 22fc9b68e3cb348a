//! Axis-aligned boxes.

use glam::Vec3;

/// The closed box from `min` to `max`. An empty box has `min > max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// The min corner.
    pub min: Vec3,
    /// The max corner.
    pub max: Vec3,
}

impl Aabb {
    /// The empty box, the neutral element of [`Aabb::union`].
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The bounding box of points.
    pub fn around(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    /// The bounding box of two boxes.
    #[inline(always)]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The intersection of two boxes, possibly empty.
    #[inline(always)]
    pub fn intersection(self, other: Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// Return whether it is empty.
    pub fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// Return whether it contains `other`, borders included. Every box contains an empty one.
    pub fn contains(&self, other: &Self) -> bool {
        other.is_empty() || (self.min.cmple(other.min).all() && self.max.cmpge(other.max).all())
    }

    /// Half the surface area, which suffices for the surface area heuristic; 0 for an empty box.
    #[inline(always)]
    pub fn half_area(&self) -> f32 {
        let d = (self.max - self.min).max(Vec3::ZERO);
        d.x * (d.y + d.z) + d.y * d.z
    }
}
