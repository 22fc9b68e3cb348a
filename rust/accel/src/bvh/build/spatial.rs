//! From the top down by the surface-area heuristic, where a primitive that straddles a plane may be parted by it
//! (Stich, Friedrich and Dietrich, "Spatial Splits in Bounding Volume Hierarchies", 2009).
//!
//! What is sorted are references: a primitive with the box around a part of it, which another may share. Where the two
//! sides of the best split of the set overlap, planes that part what they cut are weighed too, in bins that hold the
//! parts. A straddling reference that costs less when it is left whole goes to one side ("reference unsplitting"). How
//! many references may be added is bounded; a subtree gets what its parent has left in proportion to its references, so
//! that threads need not share it. That spends it badly where some need many cuts and others none, so what gains most
//! is better cut before, wherever it is: `presplit`. Sets that are small beside the scene are left to `binned`.

use super::binned::{MAX_BINS, Task};
use super::bins::{Side, Split};
use super::chopped::Plane;
use super::part::Part;
use super::reference::{Extents, Reference, median, partition, references};
use super::top_down::{Due, TASK};
use super::{BinaryBvh, Leaves, Shapes, spare};
use raywright_base::math::Aabb;
use raywright_base::parallel;
use raywright_base::work::{Stopped, Work};
use std::borrow::Cow;

/// How to build.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Bins an axis, from 2 to [`MAX_BINS`].
    pub bins: usize,
    /// How many references may be added, over the number of primitives; from 0 to [`MAX_BUDGET`].
    pub budget: f32,
    /// When a leaf is made.
    pub leaves: Leaves,
}

/// Most that may be asked for.
pub const MAX_BUDGET: f32 = 8.0;

/// Enough for most of what long diagonal geometry has to gain. Where planes gain nothing, it is not used up.
pub const BUDGET: f32 = 4.0;

/// So many references can be told apart by a wide tree.
const MOST: usize = (1 << 28) - 2;

/// Planes are weighed where the sides overlap by more than this share of the root's area (α in the paper): where they
/// overlap by less, hardly a ray meets both for nothing.
const OVERLAP: f32 = 1e-3;

/// And by more than this share of the set's own. What parting saves is not more than the overlap, and in a mesh of even
/// triangles neighbours overlap everywhere by a little.
const OWN_OVERLAP: f32 = 0.2;

/// Builds a tree over boxes, leaving out empty ones; a primitive may stand in several leaves, each of which holds what
/// is left of it in a box.
///
/// Takes time n log n on any input: sets that cannot be parted by area are halved by number, and so are all from a
/// depth on that a reasonable tree does not reach.
///
/// # Panics
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
    let shared = Shared { shapes, bins, leaves, overlap: OVERLAP * extents.all.half_area(), work };
    let all = Parts { references, extents, spare: spare(count), budget, shared: &shared };
    all.build(Due::all(count, &steps))?.assemble(Vec::new(), place)
}

struct Shared<'a, S> {
    shapes: &'a S,
    bins: usize,
    leaves: Leaves,
    /// Half the surface that sides may have in common before planes are weighed.
    overlap: f32,
    work: Work<'a>,
}

struct Parts<'a, S> {
    references: Vec<Reference>,
    extents: Extents,
    /// How many more levels may be split by area.
    spare: usize,
    /// How many more references there may be.
    budget: usize,
    shared: &'a Shared<'a, S>,
}

impl<S: Shapes> Parts<'_, S> {
    fn build(mut self, due: Due) -> Result<Part, Stopped> {
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
                Ok(Part::pair(aabb, left?, right?))
            }
            Err(leaf) => {
                due.tell()?;
                Ok(Part::leaf(aabb, &leaf))
            }
        }
    }

    /// Builds a subtree on this thread.
    fn build_alone(mut self) -> Part {
        if let Some(task) = self.without_planes() {
            return task.build_alone(&mut self.references, self.extents);
        }
        let aabb = self.extents.all.aabb();
        match self.split() {
            Ok([left, right]) => Part::pair(aabb, left.build_alone(), right.build_alone()),
            Err(leaf) => Part::leaf(aabb, &leaf),
        }
    }

    /// How to build where nothing is to be parted any more.
    fn without_planes(&self) -> Option<Task> {
        let Shared { bins, leaves, overlap, .. } = *self.shared;
        // Sides have no more in common than the set has, nor do those of its parts.
        let is_small = self.references.len() <= leaves.block || self.extents.all.half_area() <= overlap;
        let is_over = self.budget == 0 || self.spare == 0;
        (is_small || is_over).then_some(Task { bins, leaves, spare: self.spare, first: None })
    }

    /// Two sets of it, neither empty; or what is in it, if it is to be a leaf.
    fn split(self) -> Result<[Self; 2], Vec<Reference>> {
        let Self { mut references, extents, spare, budget, shared } = self;
        let count = references.len();
        let whole = Split::best_with_sides(&references, &extents, shared.bins);
        let plane = shared.best_plane(&references, &extents, whole.map(|whole| whole.1), budget);
        // Where nothing is parted after all, one side may be empty.
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

impl<S: Shapes> Shared<'_, S> {
    /// The best plane, where it costs less than the best split without, of which this lies on either side.
    fn best_plane(
        &self,
        references: &[Reference],
        extents: &Extents,
        whole: Option<[Side; 2]>,
        budget: usize,
    ) -> Option<Plane> {
        let area = extents.all.half_area();
        let mut least = area * references.len() as f32;
        if let Some([left, right]) = whole {
            let common = left.1.common(&right.1);
            if common.is_empty() || common.half_area() <= self.overlap.max(OWN_OVERLAP * area) {
                return None;
            }
            least = least.min(left.1.half_area() * left.0 as f32 + right.1.half_area() * right.0 as f32);
        }
        let plane = Plane::best(references, &extents.all, self.bins, self.shapes, budget, self.work);
        plane.filter(|plane| plane.cost() < least)
    }
}
