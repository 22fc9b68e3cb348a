//! From the top down by the surface-area heuristic, where a primitive that straddles a plane may be parted by it
//! (Stich, Friedrich and Dietrich, "Spatial Splits in Bounding Volume Hierarchies", 2009).
//!
//! What is sorted are references: a primitive with the box around a part of it, which another may share. Where the two
//! sides of the best split of the set overlap, planes that part what they cut are weighed too, in bins that hold the
//! parts. A straddling reference that costs less when it is left whole goes to one side ("reference unsplitting"). How
//! many references may be added is bounded; a subtree gets what its parent has left in proportion to its references, so
//! that threads need not share it. That spends it badly where some need many cuts and others none, so what gains most
//! is better cut before, wherever it is: `presplit`.

use super::binned::MAX_BINS;
use super::bins::{Bins, Split};
use super::chopped::{Chopped, Plane};
use super::reference::{Bounds, Extents, MANY, Reference, SHARE, median, partition, references};
use super::top_down::{self, Set};
use super::{BinaryBvh, Leaves, spare};
use crate::math::Aabb;
use crate::work::{Stopped, Work};
use rayon::prelude::*;
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
/// is left of it in a box. `clip` is as [`Builder::build`](super::Builder::build) says.
///
/// Takes time n log n on any input: sets that cannot be parted by area are halved by number, and so are all from a
/// depth on that a reasonable tree does not reach.
///
/// # Panics
/// If an option is out of range.
pub fn build<'a>(
    boxes: impl Into<Cow<'a, [Aabb]>>,
    clip: impl Fn(u32, &Aabb) -> Aabb + Sync,
    options: &Options,
    work: Work,
) -> Result<BinaryBvh, Stopped> {
    let Options { bins, budget, leaves } = *options;
    assert!((2..=MAX_BINS).contains(&bins), "bins is {bins}, not from 2 to {MAX_BINS}");
    assert!((0.0..=MAX_BUDGET).contains(&budget), "budget is {budget}, not from 0 to {MAX_BUDGET}");
    leaves.check();
    let [gather, grow] = work.parts([1.0, 40.0]);
    let references = references(boxes, gather)?;
    if references.is_empty() {
        return Ok(BinaryBvh::default());
    }
    let count = references.len();
    let budget = ((f64::from(budget) * count as f64) as usize).min(MOST.saturating_sub(count));
    let extents = Extents::around_many(&references);
    let shared = Shared { clip, bins, leaves, overlap: OVERLAP * extents.all.half_area() };
    top_down::build(Parts { references, extents, spare: spare(count), budget, shared: &shared }, grow)
}

struct Shared<C> {
    clip: C,
    bins: usize,
    leaves: Leaves,
    /// Half the surface that sides may have in common before planes are weighed.
    overlap: f32,
}

struct Parts<'a, C> {
    references: Vec<Reference>,
    extents: Extents,
    /// How many more levels may be split by area.
    spare: usize,
    /// How many more references there may be.
    budget: usize,
    shared: &'a Shared<C>,
}

/// What is reused from node to node.
pub struct Workspace {
    whole: Bins,
    chopped: Chopped,
}

impl Default for Workspace {
    fn default() -> Self {
        Self { whole: Bins::new(), chopped: Chopped::new() }
    }
}

impl<C: Fn(u32, &Aabb) -> Aabb + Sync> Set for Parts<'_, C> {
    type Workspace = Workspace;

    fn len(&self) -> usize {
        self.references.len()
    }

    fn aabb(&self) -> Aabb {
        self.extents.all.aabb()
    }

    fn split(self, workspace: &mut Workspace) -> Result<[Self; 2], Self> {
        let (count, shared) = (self.len(), self.shared);
        if count <= shared.leaves.whole {
            return Err(self);
        }
        let whole = if self.spare > 0 { self.best_whole(&mut workspace.whole) } else { None };
        let plane = if self.spare > 0 { self.best_plane(whole.as_ref(), &mut workspace.chopped) } else { None };
        let Self { mut references, extents, spare, budget, .. } = self;
        // Where nothing is parted after all, one side may be empty.
        let parted = plane.map(|plane| plane.part(&references, &shared.clip));
        let (mut left, right) = match parted.filter(|(left, right)| !left.is_empty() && !right.is_empty()) {
            Some(sides) => sides,
            None => {
                let middle = match whole {
                    Some(Whole { split, .. }) => partition(&mut references, |r| split.is_left(r)),
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
            return Err(Self { references, extents, spare, budget, shared });
        }
        let both = left.len() + right.len();
        let unused = budget - (both - count);
        let share = (unused as u64 * left.len() as u64 / both as u64) as usize;
        let side = |references, extents, budget| {
            let spare = spare.saturating_sub(1);
            Self { references, extents, spare, budget, shared }
        };
        Ok([side(left, around[0], share), side(right, around[1], unused - share)])
    }

    fn list(&self, order: &mut Vec<u32>) {
        order.extend(self.references.iter().map(Reference::primitive));
    }
}

/// The best split of a set, each reference as a whole.
struct Whole {
    split: Split,
    cost: f32,
    /// Half the surface that the sides have in common.
    overlap: f32,
}

impl<C: Fn(u32, &Aabb) -> Aabb + Sync> Parts<'_, C> {
    fn best_whole(&self, bins: &mut Bins) -> Option<Whole> {
        let (references, count) = (&self.references, self.shared.bins);
        let few = references.len() < MANY;
        let split = if few {
            Split::best(references, &self.extents, count, bins)
        } else {
            Split::best_of_many(references, &self.extents, count)
        }?;
        let none = [(0, Bounds::EMPTY); 2];
        let grown = |mut sides: [(usize, Bounds); 2], share: &[Reference]| {
            for r in share {
                let (count, bounds) = &mut sides[usize::from(!split.is_left(r))];
                *count += 1;
                bounds.grow(&r.bounds);
            }
            sides
        };
        let join = |a: [(usize, Bounds); 2], b: [(usize, Bounds); 2]| {
            [0, 1].map(|side| (a[side].0 + b[side].0, a[side].1.union(&b[side].1)))
        };
        let sides = if few {
            grown(none, references)
        } else {
            references.par_chunks(SHARE).fold(|| none, grown).reduce(|| none, join)
        };
        let [left, right] = sides;
        let common = left.1.common(&right.1);
        Some(Whole {
            split,
            cost: left.1.half_area() * left.0 as f32 + right.1.half_area() * right.0 as f32,
            overlap: if common.is_empty() { 0.0 } else { common.half_area() },
        })
    }

    /// The best plane, where it costs less than the best split without.
    fn best_plane(&self, whole: Option<&Whole>, chopped: &mut Chopped) -> Option<Plane> {
        let area = self.extents.all.half_area();
        let worth = whole.is_none_or(|whole| whole.overlap > self.shared.overlap.max(OWN_OVERLAP * area));
        if !worth || self.budget == 0 {
            return None;
        }
        let unsplit = area * self.references.len() as f32;
        let least = whole.map_or(unsplit, |whole| whole.cost.min(unsplit));
        let bins = self.shared.bins;
        Plane::best(&self.references, &self.extents.all, bins, &self.shared.clip, self.budget, chopped)
            .filter(|plane| plane.cost() < least)
    }
}
