//! The references that builders sort: boxes with primitive numbers.

use glam::{Vec4, Vec4Swizzles};
use raywright_base::math::{Aabb, Vec3};
use raywright_base::parallel;
use raywright_base::work::{Stopped, Work};
use std::borrow::Cow;
use std::ops::Range;

/// References per parallel task in a large node.
pub const SHARE: usize = 1 << 14;

/// Minimum number of references for parallel processing.
pub const MANY: usize = 1 << 16;

/// A growing box, stored as the min corner and the negated max corner, so that both grow by a minimum. `w` is ignored.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Bounds {
    min: Vec4,
    neg_max: Vec4,
}

impl Bounds {
    /// The empty box.
    pub const EMPTY: Self = Self { min: Vec4::INFINITY, neg_max: Vec4::INFINITY };

    /// The box of a point.
    #[inline(always)]
    pub fn point(at: Vec4) -> Self {
        Self { min: at, neg_max: -at }
    }

    /// Extend it to contain another one.
    #[inline(always)]
    pub fn grow(&mut self, other: &Self) {
        self.min = self.min.min(other.min);
        self.neg_max = self.neg_max.min(other.neg_max);
    }

    /// The union of two boxes.
    #[inline(always)]
    pub fn union(mut self, other: &Self) -> Self {
        self.grow(other);
        self
    }

    /// Convert to an [`Aabb`].
    pub fn aabb(&self) -> Aabb {
        Aabb { min: self.min.truncate(), max: -self.neg_max.truncate() }
    }

    /// The intersection of two boxes, possibly empty ([`Bounds::is_empty`]).
    #[inline(always)]
    pub fn common(&self, other: &Self) -> Self {
        Self { min: self.min.max(other.min), neg_max: self.neg_max.max(other.neg_max) }
    }

    /// Return whether the box is empty.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.size().truncate().cmplt(Vec3::ZERO).any()
    }

    /// The min corner.
    #[inline(always)]
    pub fn least(&self) -> Vec4 {
        self.min
    }

    /// The max corner.
    #[inline(always)]
    pub fn greatest(&self) -> Vec4 {
        -self.neg_max
    }

    /// The extent along each axis; not positive if flat or empty.
    #[inline(always)]
    pub fn size(&self) -> Vec4 {
        -(self.min + self.neg_max)
    }

    /// The axis of greatest extent.
    #[inline(always)]
    pub fn longest(&self) -> usize {
        let [x, y, z, _] = self.size().to_array();
        if x >= y && x >= z { 0 } else { 1 + usize::from(z > y) }
    }

    /// Half the surface area; NaN for an empty box.
    #[inline(always)]
    pub fn half_area(&self) -> f32 {
        // The signs cancel.
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

/// A box with its primitive's number.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct Reference {
    /// The lower half of the number is stored in the first `w`, the upper half in the second, both as floats. The bits
    /// of an integer would be subnormal floats, which are slow.
    pub bounds: Bounds,
}

impl Reference {
    /// A primitive and its box.
    pub fn new(aabb: &Aabb, primitive: u32) -> Self {
        let half = |bits: u32| (bits & 0xffff) as f32;
        let (min, neg_max) = (aabb.min.extend(half(primitive)), (-aabb.max).extend(half(primitive >> 16)));
        Self { bounds: Bounds { min, neg_max } }
    }

    /// The primitive's number.
    pub fn primitive(&self) -> u32 {
        self.bounds.min.w as u32 | (self.bounds.neg_max.w as u32) << 16
    }

    /// Twice the box's center.
    #[inline(always)]
    pub fn centre(&self) -> Vec4 {
        self.bounds.min - self.bounds.neg_max
    }

    /// The same along one axis.
    #[inline(always)]
    pub fn centre_on(&self, axis: usize) -> f32 {
        let Bounds { min, neg_max } = &self.bounds;
        min.as_ref()[axis] - neg_max.as_ref()[axis]
    }
}

/// The bounds of references, and of their (doubled) centers.
#[derive(Clone, Copy)]
pub struct Extents {
    /// The bounds of the boxes.
    pub all: Bounds,
    /// The bounds of the centers, doubled.
    pub centres: Bounds,
}

impl Extents {
    /// No references.
    pub const EMPTY: Self = Self { all: Bounds::EMPTY, centres: Bounds::EMPTY };

    /// The extents of references.
    #[inline(always)]
    pub fn around(references: &[Reference]) -> Self {
        let mut extents = Self::EMPTY;
        for r in references {
            extents.all.grow(&r.bounds);
            extents.centres.grow(&Bounds::point(r.centre()));
        }
        extents
    }

    /// The union of two sets.
    pub fn union(self, other: Self) -> Self {
        Self { all: self.all.union(&other.all), centres: self.centres.union(&other.centres) }
    }
}

impl Extents {
    /// The extents of references, in parallel for many.
    pub fn around_many(references: &[Reference]) -> Self {
        if references.len() < MANY {
            Self::around(references)
        } else {
            let shares = parallel::map_chunks(references.len(), SHARE, |share| Self::around(&references[share]));
            shares.into_iter().fold(Self::EMPTY, Self::union)
        }
    }
}

/// References to all nonempty boxes. Owned boxes are freed.
pub fn references<'a>(boxes: impl Into<Cow<'a, [Aabb]>>, work: Work) -> Result<Vec<Reference>, Stopped> {
    let boxes = boxes.into();
    let reference = |i: usize| Reference::new(&boxes[i], i as u32);
    let counts = |share: Range<usize>| boxes[share].iter().filter(|b| !b.is_empty()).count();
    if parallel::map_chunks(boxes.len(), SHARE, counts).iter().sum::<usize>() < boxes.len() {
        work.goes_on()?;
        let there = |share: Range<usize>| share.filter(|&i| !boxes[i].is_empty()).map(reference).collect::<Vec<_>>();
        Ok(parallel::map_chunks(boxes.len(), SHARE, there).concat())
    } else {
        // Without empty boxes the positions are known, so references are written directly.
        work.collect(boxes.len(), reference)
    }
}

/// Move left references to the front and return their number. Branchless, since a branch would often be mispredicted.
#[inline(always)]
pub fn partition(references: &mut [Reference], is_left: impl Fn(&Reference) -> bool) -> usize {
    let mut left = 0;
    for i in 0..references.len() {
        references.swap(i, left);
        left += usize::from(is_left(&references[left]));
    }
    left
}

/// Split at the median along the longest axis of the centers; equal centers are ordered by primitive.
pub fn median(references: &mut [Reference], centres: &Bounds) -> usize {
    let axis = centres.longest();
    let middle = references.len() / 2;
    references.select_nth_unstable_by(middle, |a, b| {
        a.centre_on(axis).total_cmp(&b.centre_on(axis)).then(a.primitive().cmp(&b.primitive()))
    });
    middle
}
