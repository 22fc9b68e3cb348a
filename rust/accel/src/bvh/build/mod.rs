//! Builders of the binary tree. They see boxes, never shapes.
//!
//! Trees come laid out depth first: behind a pair of children stands all that is below the first, then all that is
//! below the second, and leaves refer to the primitives in the same order. However many threads build, the tree is the
//! same.

pub mod binned;
mod bins;
mod chop;
mod chopped;
pub mod halves;
mod leaves;
pub mod morton;
mod part;
pub mod ploc;
pub(super) mod presplit;
mod radix;
pub(super) mod reference;
mod slices;
pub mod spatial;
pub mod sweep;
#[cfg(test)]
mod tests;
mod top_down;

pub use leaves::Leaves;
pub(super) use reference::Bounds;

use super::{BinaryBvh, Node};
use halves::Way;
use raywright_base::math::{Aabb, Vec3};
use raywright_base::work::{Stopped, Work};
use std::borrow::Cow;

/// What is in the boxes, as far as it can be parted. A function that clips will do.
pub trait Shapes: Sync {
    /// A box around what of a primitive lies in another box, or around more. It must be empty only where there is
    /// nothing, and lie within the primitive's own box and the other one.
    fn clip(&self, primitive: u32, to: &Aabb) -> Aabb;

    /// About where a triangle's corners are, by which its parts are estimated; none if it is asked to clip for that.
    fn corners(&self, _primitive: u32) -> Option<[Vec3; 3]> {
        None
    }
}

impl<F: Fn(u32, &Aabb) -> Aabb + Sync> Shapes for F {
    fn clip(&self, primitive: u32, to: &Aabb) -> Aabb {
        self(primitive, to)
    }
}

/// How a binary tree is built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Builder {
    /// By the surface-area heuristic in bins: [`binned`].
    Binned {
        /// Bins an axis, from 2 to [`binned::MAX_BINS`].
        bins: Option<usize>,
    },
    /// By the surface-area heuristic at every place: [`sweep`].
    Sweep,
    /// By the surface-area heuristic with spatial splits: [`spatial`].
    Spatial {
        /// Bins an axis, from 2 to [`binned::MAX_BINS`].
        bins: Option<usize>,
        /// How many references may be added, over the number of primitives.
        budget: f32,
    },
    /// By Morton codes: [`morton`].
    Morton(morton::Bits),
    /// Bottom up by locally ordered clustering: [`ploc`].
    Ploc {
        /// How far off in the order of Morton codes a neighbour is sought, from 1 to [`ploc::MAX_RADIUS`].
        radius: usize,
    },
    /// By halves: [`halves`].
    Halves(Way),
}

impl Builder {
    /// What is meant by bins where nobody says how many.
    const BINS: usize = 16;

    /// The same with so many bins, if it has any.
    pub fn with_bins(self, bins: usize) -> Self {
        match self {
            Self::Binned { .. } => Self::Binned { bins: Some(bins) },
            Self::Spatial { budget, .. } => Self::Spatial { bins: Some(bins), budget },
            other => other,
        }
    }

    /// The same with so many bins where nobody has said how many.
    pub fn or_bins(self, some: usize) -> Self {
        match self {
            Self::Binned { bins } => Self::Binned { bins: bins.or(Some(some)) },
            Self::Spatial { bins, budget } => Self::Spatial { bins: bins.or(Some(some)), budget },
            other => other,
        }
    }

    /// Its name, for people.
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

    /// Whether a primitive may stand in several leaves, part by part.
    pub const fn parts(&self) -> bool {
        matches!(self, Self::Spatial { .. })
    }

    /// The same over pieces of primitives that were cut before: the pieces beyond one for each primitive count as
    /// references that are added already.
    pub fn over_pieces(self, primitives: usize, pieces: usize) -> Self {
        match self {
            Self::Spatial { bins, budget } => {
                let left = budget * primitives as f32 - (pieces - primitives) as f32;
                Self::Spatial { bins, budget: left.max(0.0) / pieces as f32 }
            }
            other => other,
        }
    }

    /// Makes a tree over boxes, leaving out empty ones.
    ///
    /// Only spatial splits ask what is in the boxes.
    ///
    /// Boxes that are given away are freed as soon as they are not needed any more.
    ///
    /// # Panics
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
            Self::Halves(way) => halves::build(boxes, way, &leaves, work),
        }
    }
}

/// How many levels are split as the heuristic wants it, before halves by number bound the depth of what is left: a
/// reasonable tree is not as deep.
fn spare(references: usize) -> usize {
    2 * references.max(1).ilog2() as usize + 40
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
