//! A top-down builder with the surface area heuristic and spatial splits, which may split straddling primitives (Stich,
//! Friedrich and Dietrich, "Spatial Splits in Bounding Volume Hierarchies", 2009).
//!
//! A reference is a primitive with the box of one of its parts. If the two sides of the best object split overlap,
//! spatial splits are evaluated too, in bins of the parts. A straddling reference goes to one side as a whole if that
//! is cheaper ("reference unsplitting"). The number of added references is bounded. Subtrees inherit the remaining
//! budget in proportion to their references, so that threads need not share it. That wastes budget if some subtrees
//! need many splits and others none, so large gains are better realized beforehand, anywhere in the scene: `presplit`.
//! Sets that are small relative to the scene are left to `binned`.

use super::binned::{MAX_BINS, Task};
use super::bins::{BinSide, Split};
use super::chopped::ChopPlane;
use super::reference::{Extents, Reference, median, partition, references};
use super::subtree::Subtree;
use super::top_down::{Due, TASK};
use super::{BinaryBvh, Leaves, Shapes, spare};
use raywright_base::math::Aabb;
use raywright_base::parallel;
use raywright_base::work::{Stopped, Work};
use std::borrow::Cow;

/// Build options.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Bins per axis, from 2 to [`MAX_BINS`].
    pub bins: usize,
    /// Maximum number of added references per primitive, from 0 to [`MAX_BUDGET`].
    pub budget: f32,
    /// When a leaf is made.
    pub leaves: Leaves,
}

/// Maximum budget.
pub const MAX_BUDGET: f32 = 8.0;

/// Enough for most of the gain on long diagonal geometry. Without gain it is not used up.
pub const BUDGET: f32 = 4.0;

/// Maximum number of references that a wide tree can index.
const MOST: usize = (1 << 28) - 2;

/// Spatial splits are evaluated if the sides' overlap exceeds this fraction of the root's area (α in the paper). With
/// less overlap, hardly any ray hits both sides in vain.
const OVERLAP: f32 = 1e-3;

/// The overlap must also exceed this fraction of the set's own area. The saving is at most the overlap, and in a
/// regular mesh all neighbors overlap slightly.
const OWN_OVERLAP: f32 = 0.2;

/// Build a tree over boxes, skipping empty ones. A primitive may be in several leaves, each with the box of one of its
/// parts.
///
/// Time is n log n on any input: sets that cannot be split by area are split at the median, and so are all beyond a
/// depth that no reasonable tree reaches.
///
/// # Panics
///
/// If an option is out of range.
pub fn build<'a>(
    boxes: impl Into<Cow<'a, [Aabb]>>,
    shapes: &impl Shapes,
    options: &Options,
    work: Work,
) -> Result<BinaryBvh, Stopped> {
    let Options { bins, budget, leaves } = *options;
    assert!((2..=MAX_BINS).contains(&bins), "bins is {bins}, not from 2 to {MAX_BINS}");
    assert!((0.0..=MAX_BUDGET).contains(&budget), "budget is {budget}, not from 0 to {MAX_BUDGET}");
    leaves.check();
    let [gather, grow, place] = work.parts([1.0, 40.0, 3.0]);
    let references = references(boxes, gather)?;
    if references.is_empty() {
        return Ok(BinaryBvh::default());
    }
    let count = references.len();
    let budget = ((f64::from(budget) * count as f64) as usize).min(MOST.saturating_sub(count));
    let extents = Extents::around_many(&references);
    let steps = Due::steps(count, grow);
    let shared = SpatialContext { shapes, bins, leaves, overlap: OVERLAP * extents.all.half_area(), work };
    let all = SplitParts { references, extents, spare: spare(count), budget, shared: &shared };
    all.build(Due::all(count, &steps))?.assemble(Vec::new(), place)
}

struct SpatialContext<'a, S> {
    shapes: &'a S,
    bins: usize,
    leaves: Leaves,
    /// The overlap, as half a surface area, above which spatial splits are evaluated.
    overlap: f32,
    work: Work<'a>,
}

struct SplitParts<'a, S> {
    references: Vec<Reference>,
    extents: Extents,
    /// The remaining number of levels with splits by area.
    spare: usize,
    /// The remaining budget of references.
    budget: usize,
    shared: &'a SpatialContext<'a, S>,
}

impl<S: Shapes> SplitParts<'_, S> {
    fn build(mut self, due: Due) -> Result<Subtree, Stopped> {
        if self.references.len() <= TASK {
            let part = self.build_alone();
            due.tell()?;
            return Ok(part);
        }
        if let Some(task) = self.without_planes() {
            return task.build(&mut self.references, self.extents, due);
        }
        let aabb = self.extents.all.aabb();
        match self.split() {
            Ok([left, right]) => {
                let [of_left, of_right] = due.split([&left, &right].map(|side| side.references.len()))?;
                let (left, right) = parallel::join(|| left.build(of_left), || right.build(of_right));
                Ok(Subtree::pair(aabb, left?, right?))
            }
            Err(leaf) => {
                due.tell()?;
                Ok(Subtree::leaf(aabb, &leaf))
            }
        }
    }

    /// Build a subtree on this thread.
    fn build_alone(mut self) -> Subtree {
        if let Some(task) = self.without_planes() {
            return task.build_alone(&mut self.references, self.extents);
        }
        let aabb = self.extents.all.aabb();
        match self.split() {
            Ok([left, right]) => Subtree::pair(aabb, left.build_alone(), right.build_alone()),
            Err(leaf) => Subtree::leaf(aabb, &leaf),
        }
    }

    /// The parameters of a build without further spatial splits, if none are possible.
    fn without_planes(&self) -> Option<Task> {
        let SpatialContext { bins, leaves, overlap, .. } = *self.shared;
        // The overlap of sides is at most the set's own box, also further down.
        let is_small = self.references.len() <= leaves.block || self.extents.all.half_area() <= overlap;
        let is_over = self.budget == 0 || self.spare == 0;
        (is_small || is_over).then_some(Task { bins, leaves, spare: self.spare, first: None })
    }

    /// Split the set into two nonempty ones; return its references if it becomes a leaf.
    fn split(self) -> Result<[Self; 2], Vec<Reference>> {
        let Self { mut references, extents, spare, budget, shared } = self;
        let count = references.len();
        let whole = Split::best_with_sides(&references, &extents, shared.bins);
        let plane = shared.best_plane(&references, &extents, whole.map(|whole| whole.1), budget);
        // If no reference is split after all, one side may be empty.
        let parted = plane.map(|plane| plane.part(&references, shared.shapes));
        let (mut left, right) = match parted.filter(|(left, right)| !left.is_empty() && !right.is_empty()) {
            Some(sides) => sides,
            None => {
                let middle = match whole {
                    Some((split, _)) => partition(&mut references, |r| split.is_left(r)),
                    None => median(&mut references, &extents.centres),
                };
                let right = references.split_off(middle);
                (std::mem::take(&mut references), right)
            }
        };
        let around = [&left, &right].map(|side| Extents::around_many(side));
        let sides = [(left.len(), around[0].all.half_area()), (right.len(), around[1].all.half_area())];
        if shared.leaves.is_leaf((count, extents.all.half_area()), sides) {
            if references.is_empty() {
                left.extend(right);
                references = left;
            }
            return Err(references);
        }
        let both = left.len() + right.len();
        let unused = budget - (both - count);
        let share = (unused as u64 * left.len() as u64 / both as u64) as usize;
        let side = |references, extents, budget| Self { references, extents, spare: spare - 1, budget, shared };
        Ok([side(left, around[0], share), side(right, around[1], unused - share)])
    }
}

impl<S: Shapes> SpatialContext<'_, S> {
    /// The best spatial split, if it is cheaper than the best object split, given by its two sides.
    fn best_plane(
        &self,
        references: &[Reference],
        extents: &Extents,
        whole: Option<[BinSide; 2]>,
        budget: usize,
    ) -> Option<ChopPlane> {
        let area = extents.all.half_area();
        let mut least = area * references.len() as f32;
        if let Some([left, right]) = whole {
            let common = left.1.common(&right.1);
            if common.is_empty() || common.half_area() <= self.overlap.max(OWN_OVERLAP * area) {
                return None;
            }
            least = least.min(left.1.half_area() * left.0 as f32 + right.1.half_area() * right.0 as f32);
        }
        let plane = ChopPlane::best(references, &extents.all, self.bins, self.shapes, budget, self.work);
        plane.filter(|plane| plane.cost() < least)
    }
}
