//! Builders of the binary tree. They see boxes, never shapes.

pub mod binned;

use super::{BinaryBvh, Node};
use crate::math::Aabb;
use glam::Vec4;

/// A box with the number of its primitive, as builders sort them: 32 bytes, moved and joined as two vectors.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
struct Reference {
    /// The least corner; `w` is the lower half of the primitive's number.
    min: Vec4,
    /// The greatest corner; `w` is the upper half. Halves, as the bits of a whole number would make subnormals, which
    /// slow arithmetic down.
    max: Vec4,
}

impl Reference {
    fn new(bounds: &Aabb, primitive: u32) -> Self {
        let half = |bits: u32| (bits & 0xffff) as f32;
        Self { min: bounds.min.extend(half(primitive)), max: bounds.max.extend(half(primitive >> 16)) }
    }

    fn primitive(&self) -> u32 {
        self.min.w as u32 | (self.max.w as u32) << 16
    }

    /// Twice the box's centre.
    #[inline(always)]
    fn centre(&self) -> Vec4 {
        self.min + self.max
    }
}

/// A box that grows, in vectors of four; what stands in `w` does not count.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    min: Vec4,
    max: Vec4,
}

impl Bounds {
    const EMPTY: Self = Self { min: Vec4::INFINITY, max: Vec4::NEG_INFINITY };

    #[inline(always)]
    fn grow(&mut self, min: Vec4, max: Vec4) {
        self.min = self.min.min(min);
        self.max = self.max.max(max);
    }

    #[inline(always)]
    fn union(mut self, other: Self) -> Self {
        self.grow(other.min, other.max);
        self
    }

    fn aabb(&self) -> Aabb {
        Aabb { min: self.min.truncate(), max: self.max.truncate() }
    }

    #[inline(always)]
    fn half_area(&self) -> f32 {
        let d = self.max - self.min;
        d.x * (d.y + d.z) + d.y * d.z
    }
}
