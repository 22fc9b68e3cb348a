//! Builders of the binary tree. They see boxes, never shapes.
//!
//! Trees come laid out depth first: behind a pair of children stands all that is below the first, then all that is below
//! the second, and leaves refer to the primitives in the same order.

pub mod binned;
mod bins;
mod part;

use super::{BinaryBvh, Node};
use crate::math::Aabb;
use glam::{Vec4, Vec4Swizzles};

/// A box that grows: its least corner, and its greatest with all signs turned, so that both grow by taking the lesser. What
/// stands in `w` does not count.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Bounds {
    min: Vec4,
    neg_max: Vec4,
}

impl Bounds {
    const EMPTY: Self = Self { min: Vec4::INFINITY, neg_max: Vec4::INFINITY };

    #[inline(always)]
    fn point(at: Vec4) -> Self {
        Self { min: at, neg_max: -at }
    }

    #[inline(always)]
    pub fn grow(&mut self, other: &Self) {
        self.min = self.min.min(other.min);
        self.neg_max = self.neg_max.min(other.neg_max);
    }

    #[inline(always)]
    pub fn union(mut self, other: &Self) -> Self {
        self.grow(other);
        self
    }

    pub fn aabb(&self) -> Aabb {
        Aabb { min: self.min.truncate(), max: -self.neg_max.truncate() }
    }

    /// How long it is along each axis; not positive where it is flat, or empty.
    #[inline(always)]
    fn size(&self) -> Vec4 {
        -(self.min + self.neg_max)
    }

    /// The axis along which it is longest.
    #[inline(always)]
    fn longest(&self) -> usize {
        let [x, y, z, _] = self.size().to_array();
        if x >= y && x >= z { 0 } else { 1 + usize::from(z > y) }
    }

    /// Half the surface; of an empty box, no number.
    #[inline(always)]
    pub fn half_area(&self) -> f32 {
        // The signs cancel out.
        let d = self.min + self.neg_max;
        let [x, y, z, _] = (d * d.yzxw()).to_array();
        x + y + z
    }
}

impl From<&Aabb> for Bounds {
    fn from(aabb: &Aabb) -> Self {
        Self { min: aabb.min.extend(0.0), neg_max: (-aabb.max).extend(0.0) }
    }
}

/// A box with the number of its primitive, as builders sort them.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
struct Reference {
    /// The lower half of the primitive's number stands in the first `w`, the upper in the second. Halves, as the bits of a
    /// whole number would make subnormals, which slow arithmetic down.
    bounds: Bounds,
}

impl Reference {
    fn new(aabb: &Aabb, primitive: u32) -> Self {
        let half = |bits: u32| (bits & 0xffff) as f32;
        let (min, neg_max) = (aabb.min.extend(half(primitive)), (-aabb.max).extend(half(primitive >> 16)));
        Self { bounds: Bounds { min, neg_max } }
    }

    fn primitive(&self) -> u32 {
        self.bounds.min.w as u32 | (self.bounds.neg_max.w as u32) << 16
    }

    /// Twice the box's centre.
    #[inline(always)]
    fn centre(&self) -> Vec4 {
        self.bounds.min - self.bounds.neg_max
    }

    /// The same along one axis.
    #[inline(always)]
    fn centre_on(&self, axis: usize) -> f32 {
        let Bounds { min, neg_max } = &self.bounds;
        min.as_ref()[axis] - neg_max.as_ref()[axis]
    }
}

/// Boxes of a set of references: of all that they hold, and of their centres (doubled).
#[derive(Clone, Copy)]
struct Extents {
    all: Bounds,
    centres: Bounds,
}

impl Extents {
    const EMPTY: Self = Self { all: Bounds::EMPTY, centres: Bounds::EMPTY };

    #[inline(always)]
    fn around(references: &[Reference]) -> Self {
        let mut extents = Self::EMPTY;
        for r in references {
            extents.all.grow(&r.bounds);
            extents.centres.grow(&Bounds::point(r.centre()));
        }
        extents
    }

    fn union(self, other: Self) -> Self {
        Self { all: self.all.union(&other.all), centres: self.centres.union(&other.centres) }
    }
}

/// Panics unless what is below a node lies together, the left before the right, as do its primitives.
#[cfg(test)]
pub(super) fn assert_depth_first(bvh: &BinaryBvh) {
    let (mut next, mut first) = (1, 0);
    let mut open: Vec<_> = bvh.nodes.first().into_iter().collect();
    while let Some(node) = open.pop() {
        if node.is_leaf() {
            assert_eq!(node.index, first);
            first += node.count;
        } else {
            assert_eq!(node.index, next);
            next += 2;
            open.extend(node.children().map(|child| &bvh.nodes[child]).iter().rev());
        }
    }
}
