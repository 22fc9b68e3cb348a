//! From the top down by halves along the longest axis of the centres, as textbooks begin (Kay and Kajiya, "Ray Tracing
//! Complex Scenes", 1986): at the middle of where the centres are, at their median, or at their mean. The sides' areas
//! are not looked at.

use super::reference::{Extents, Reference, SHARE, median, partition, references};
use super::top_down::{self, Set};
use super::{BinaryBvh, Leaves, spare};
use raywright_base::math::Aabb;
use raywright_base::parallel;
use raywright_base::work::{Stopped, Work};
use std::borrow::Cow;
use std::ops::Range;

/// Where to halve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Half way from the first centre to the last; at the median where all centres then are on one side.
    Midpoint,
    /// As many primitives on either side: the tree of least depth.
    Median,
    /// At the mean of the centres; at the median where all of them then are on one side.
    Mean,
}

impl Way {
    /// Its name, for people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Midpoint => "midpoints",
            Self::Median => "medians",
            Self::Mean => "means",
        }
    }
}

/// Builds a tree over boxes, leaving out empty ones. Leaves are made by number alone: at most [`Leaves::whole`]
/// primitives.
///
/// Takes time n log n on any input: from a depth on that a reasonable tree does not reach, sets are halved by number.
///
/// # Panics
/// If an option is out of range.
pub fn build<'a>(
    boxes: impl Into<Cow<'a, [Aabb]>>,
    way: Way,
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
    way: Way,
    /// Up to so many are not halved.
    whole: usize,
    /// How many more levels may be halved other than by number.
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
            Way::Midpoint => Some(middle(&extents, axis)),
            Way::Mean => Some(mean(references, axis)),
            Way::Median => None,
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

/// The middle of the centres along an axis.
fn middle(extents: &Extents, axis: usize) -> f32 {
    let Aabb { min, max } = extents.centres.aabb();
    // Halves first: the sum may be more than an f32 holds.
    min[axis] / 2.0 + max[axis] / 2.0
}

/// The mean of the centres along an axis; sums of shares of one size, so that it does not depend on threads.
fn mean(references: &[Reference], axis: usize) -> f32 {
    let sum = |share: Range<usize>| references[share].iter().map(|r| f64::from(r.centre_on(axis))).sum::<f64>();
    let shares = parallel::map_chunks(references.len(), SHARE, sum);
    (shares.iter().sum::<f64>() / references.len() as f64) as f32
}
