//! Top-down splits along the longest axis of the centers without a cost model, as in textbooks (Kay and Kajiya, "Ray
//! Tracing Complex Scenes", 1986): at the midpoint, the median, or the mean.

use super::reference::{Extents, Reference, SHARE, median, partition, references};
use super::top_down::{self, Set};
use super::{BinaryBvh, Leaves, spare};
use raywright_base::math::Aabb;
use raywright_base::parallel;
use raywright_base::work::{Stopped, Work};
use std::borrow::Cow;
use std::ops::Range;

/// The position of the split.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SplitRule {
    /// Midway between the first center and the last; the median if that separates nothing.
    Midpoint,
    /// Equal numbers on both sides, which gives the least depth.
    Median,
    /// The mean of the centers; the median if that separates nothing.
    Mean,
}

impl SplitRule {
    /// Its display name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Midpoint => "midpoints",
            Self::Median => "medians",
            Self::Mean => "means",
        }
    }
}

/// Build a tree over boxes, skipping empty ones. Leaves depend on the count alone: at most [`Leaves::whole`]
/// primitives.
///
/// Time is n log n on any input: beyond a depth that no reasonable tree reaches, sets are split at the median.
///
/// # Panics
///
/// If an option is out of range.
pub fn build<'a>(
    boxes: impl Into<Cow<'a, [Aabb]>>,
    way: SplitRule,
    leaves: &Leaves,
    work: Work,
) -> Result<BinaryBvh, Stopped> {
    leaves.check();
    let [gather, grow] = work.parts([1.0, 20.0]);
    let mut references = references(boxes, gather)?;
    if references.is_empty() {
        return Ok(BinaryBvh::default());
    }
    let (spare, extents) = (spare(references.len()), Extents::around_many(&references));
    top_down::build(Half { references: &mut references, extents, way, whole: leaves.whole, spare }, grow)
}

struct Half<'a> {
    references: &'a mut [Reference],
    extents: Extents,
    way: SplitRule,
    /// Maximum number of primitives in a leaf.
    whole: usize,
    /// The remaining number of levels with splits other than at the median.
    spare: usize,
}

impl Set for Half<'_> {
    type Workspace = ();

    fn len(&self) -> usize {
        self.references.len()
    }

    fn aabb(&self) -> Aabb {
        self.extents.all.aabb()
    }

    fn split(self, (): &mut ()) -> Result<[Self; 2], Self> {
        if self.references.len() <= self.whole {
            return Err(self);
        }
        let Self { references, extents, way, whole, spare } = self;
        let axis = extents.centres.longest();
        let at = match way {
            SplitRule::Midpoint => Some(middle(&extents, axis)),
            SplitRule::Mean => Some(mean(references, axis)),
            SplitRule::Median => None,
        };
        let count = references.len();
        let left = at.filter(|_| spare > 0).map(|at| partition(references, |r| r.centre_on(axis) < at));
        let left =
            left.filter(|&left| 0 < left && left < count).unwrap_or_else(|| median(references, &extents.centres));
        let (left, right) = references.split_at_mut(left);
        Ok([left, right].map(|references| {
            let extents = Extents::around_many(references);
            Self { references, extents, way, whole, spare: spare.saturating_sub(1) }
        }))
    }

    fn list(&self, order: &mut Vec<u32>) {
        order.extend(self.references.iter().map(Reference::primitive));
    }
}

/// The midpoint of the centers along an axis.
fn middle(extents: &Extents, axis: usize) -> f32 {
    let Aabb { min, max } = extents.centres.aabb();
    // Halved first, since the sum may overflow.
    min[axis] / 2.0 + max[axis] / 2.0
}

/// The mean of the centers along an axis. Sums over fixed chunks make it independent of the number of threads.
fn mean(references: &[Reference], axis: usize) -> f32 {
    let sum = |share: Range<usize>| references[share].iter().map(|r| f64::from(r.centre_on(axis))).sum::<f64>();
    let shares = parallel::map_chunks(references.len(), SHARE, sum);
    (shares.iter().sum::<f64>() / references.len() as f64) as f32
}
