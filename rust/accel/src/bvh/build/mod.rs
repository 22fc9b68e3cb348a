//! Builders of binary BVHs, which see boxes only.
//!
//! Trees are in depth-first order: a pair of children is followed by the subtree of the first, then that of the second,
//! and leaves refer to primitives in the same order. The result does not depend on the number of threads.

pub mod binned;
mod bins;
mod chop;
mod chopped;
mod leaves;
pub mod morton;
pub mod ploc;
pub(super) mod presplit;
mod radix;
pub(super) mod reference;
mod slices;
pub mod spatial;
pub mod split_rules;
mod subtree;
pub mod sweep;
#[cfg(test)]
mod tests;
mod top_down;

pub use leaves::Leaves;
pub(super) use reference::Bounds;

use super::{BinaryBvh, Node};
use raywright_base::math::{Aabb, Vec3};
use raywright_base::work::{Stopped, Work};
use split_rules::SplitRule;
use std::borrow::Cow;

/// The geometry inside the boxes, for splitting. Any clipping function implements it.
pub trait Shapes: Sync {
    /// A box around the part of a primitive inside another box, not necessarily tight. It must be empty only if that
    /// part is, and inside both the primitive's own box and the other one.
    fn clip(&self, primitive: u32, to: &Aabb) -> Aabb;

    /// A triangle's approximate corners for estimating its parts; None if it has to be clipped.
    fn corners(&self, _primitive: u32) -> Option<[Vec3; 3]> {
        None
    }
}

impl<F: Fn(u32, &Aabb) -> Aabb + Sync> Shapes for F {
    fn clip(&self, primitive: u32, to: &Aabb) -> Aabb {
        self(primitive, to)
    }
}

/// The algorithm of a builder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Builder {
    /// The surface area heuristic on bins: [`binned`].
    Binned {
        /// Bins per axis, from 2 to [`binned::MAX_BINS`].
        bins: Option<usize>,
    },
    /// The surface area heuristic at every position: [`sweep`].
    Sweep,
    /// The surface area heuristic with spatial splits: [`spatial`].
    Spatial {
        /// Bins per axis, from 2 to [`binned::MAX_BINS`].
        bins: Option<usize>,
        /// Maximum number of added references per primitive.
        budget: f32,
    },
    /// Morton codes: [`morton`].
    Morton(morton::Bits),
    /// Bottom-up by parallel locally-ordered clustering: [`ploc`].
    Ploc {
        /// The search radius in Morton order, from 1 to [`ploc::MAX_RADIUS`].
        radius: usize,
    },
    /// Splits without a cost model: [`split_rules`].
    Halves(SplitRule),
}

impl Builder {
    /// The default number of bins.
    const BINS: usize = 16;

    /// The same with the given number of bins, if it uses bins.
    pub fn with_bins(self, bins: usize) -> Self {
        match self {
            Self::Binned { .. } => Self::Binned { bins: Some(bins) },
            Self::Spatial { budget, .. } => Self::Spatial { bins: Some(bins), budget },
            other => other,
        }
    }

    /// The same with a default number of bins.
    pub fn or_bins(self, some: usize) -> Self {
        match self {
            Self::Binned { bins } => Self::Binned { bins: bins.or(Some(some)) },
            Self::Spatial { bins, budget } => Self::Spatial { bins: bins.or(Some(some)), budget },
            other => other,
        }
    }

    /// Its display name.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Binned { .. } => "binned SAH",
            Self::Sweep => "full-sweep SAH",
            Self::Spatial { .. } => "SAH with spatial splits",
            Self::Morton(_) => "Morton codes",
            Self::Ploc { .. } => "PLOC",
            Self::Halves(way) => way.name(),
        }
    }

    /// Return whether primitives may be split among several leaves.
    pub const fn parts(&self) -> bool {
        matches!(self, Self::Spatial { .. })
    }

    /// The same over pieces of primitives: the additional pieces count toward the budget of references.
    pub fn over_pieces(self, primitives: usize, pieces: usize) -> Self {
        match self {
            Self::Spatial { bins, budget } => {
                let left = budget * primitives as f32 - (pieces - primitives) as f32;
                Self::Spatial { bins, budget: left.max(0.0) / pieces as f32 }
            }
            other => other,
        }
    }

    /// Build a tree over boxes, skipping empty ones.
    ///
    /// Only spatial splits use the shapes. Owned boxes are freed as soon as they are not needed.
    ///
    /// # Panics
    ///
    /// If an option is out of range.
    pub fn build<'a>(
        &self,
        boxes: impl Into<Cow<'a, [Aabb]>>,
        shapes: impl Shapes,
        leaves: &Leaves,
        work: Work,
    ) -> Result<BinaryBvh, Stopped> {
        let leaves = *leaves;
        match *self {
            Self::Binned { bins } => {
                binned::build(boxes, &binned::Options { bins: bins.unwrap_or(Self::BINS), leaves }, work)
            }
            Self::Sweep => sweep::build(boxes, &leaves, work),
            Self::Spatial { bins, budget } => {
                let bins = bins.unwrap_or(Self::BINS);
                spatial::build(boxes, &shapes, &spatial::Options { bins, budget, leaves }, work)
            }
            Self::Morton(bits) => morton::build(boxes, bits, work),
            Self::Ploc { radius } => ploc::build(boxes, &ploc::Options { radius }, work),
            Self::Halves(way) => split_rules::build(boxes, way, &leaves, work),
        }
    }
}

/// The number of levels split by the heuristic, before median splits bound the depth. No reasonable tree is as deep.
fn spare(references: usize) -> usize {
    2 * references.max(1).ilog2() as usize + 40
}

/// Assert that subtrees are contiguous, the left before the right, and so are their primitives.
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
