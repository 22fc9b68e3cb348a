//! A top-down builder with the surface area heuristic at every split position along each axis (MacDonald and Booth,
//! "Heuristics for Ray Tracing Using Space Subdivision", 1990).
//!
//! Primitives are sorted once along each axis, and the three orders are partitioned stably (Wald and Havran, "On
//! building fast kd-trees for ray tracing, and on doing that in O(N log N)", 2006). Large nodes sweep the three axes in
//! parallel, and subtrees below are built in parallel.

use super::reference::{Bounds, Reference, references};
use super::top_down::{self, Set};
use super::{BinaryBvh, Leaves, spare};
use glam::Vec4;
use raywright_base::math::Aabb;
use raywright_base::parallel;
use raywright_base::work::{Stopped, Work};
use std::borrow::Cow;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Minimum number of primitives for one thread per axis.
const MANY: usize = 4096;

/// Build a tree over boxes, skipping empty ones.
///
/// Time is n log n on any input: sets that cannot be split by area are split at the median, and so are all beyond a
/// depth that no reasonable tree reaches.
///
/// # Panics
///
/// If an option is out of range.
pub fn build<'a>(boxes: impl Into<Cow<'a, [Aabb]>>, leaves: &Leaves, work: Work) -> Result<BinaryBvh, Stopped> {
    leaves.check();
    let [gather, sort, grow] = work.parts([1.0, 20.0, 100.0]);
    let references = references(boxes, gather)?;
    if references.is_empty() {
        return Ok(BinaryBvh::default());
    }
    let count = references.len();
    let sorted = |axis: usize| {
        // In the order of f32::total_cmp; equal centers are ordered by index.
        let rank = |x: f32| x.to_bits() ^ if x.is_sign_negative() { u32::MAX } else { 1 << 31 };
        let key = |i: usize| u64::from(rank(references[i].centre_on(axis))) << 32 | i as u64;
        let mut keys = parallel::collect(count, key);
        parallel::sort(&mut keys);
        parallel::collect(count, |i| keys[i] as u32)
    };
    let (steps, mut orders) = (sort.steps(3), [const { Vec::new() }; 3]);
    for (axis, order) in orders.iter_mut().enumerate() {
        *order = sorted(axis);
        steps.did(1)?;
    }
    let mut spaces = [0, 1, 2].map(|_| vec![0; count]);
    let right: Vec<_> = (0..count).map(|_| AtomicBool::new(false)).collect();
    let [x, y, z] = &mut orders;
    let [u, v, w] = &mut spaces;
    let axis = |order, space| Axis { order, space };
    let axes = [axis(x, u), axis(y, v), axis(z, w)];
    let all = around(&references, axes[0].order);
    let shared = SweepContext { references: &references, right: &right, leaves: *leaves };
    top_down::build(Sweep { axes, all, spare: spare(count), shared: &shared }, grow)
}

struct SweepContext<'a> {
    references: &'a [Reference],
    /// True if a primitive is on the right of the current split.
    right: &'a [AtomicBool],
    leaves: Leaves,
}

/// A set of primitives along one axis.
struct Axis<'a> {
    /// Sorted by center, then by index.
    order: &'a mut [u32],
    /// Scratch space of the same length.
    space: &'a mut [u32],
}

struct Sweep<'a> {
    axes: [Axis<'a>; 3],
    /// The bounding box.
    all: Bounds,
    /// The remaining number of levels with splits by area.
    spare: usize,
    shared: &'a SweepContext<'a>,
}

impl Set for Sweep<'_> {
    type Workspace = ();

    fn len(&self) -> usize {
        self.axes[0].order.len()
    }

    fn aabb(&self) -> Aabb {
        self.all.aabb()
    }

    fn split(mut self, (): &mut ()) -> Result<[Self; 2], Self> {
        let (count, shared) = (self.len(), self.shared);
        if count <= shared.leaves.whole {
            return Err(self);
        }
        let best = if self.spare > 0 { self.best() } else { None };
        let (axis, left) = best.unwrap_or_else(|| (self.longest(), count / 2));
        let (before, after) = self.axes[axis].order.split_at(left);
        let sides = [before, after].map(|side| around(shared.references, side));
        let [l, r] = sides.map(|side| side.half_area());
        if shared.leaves.is_leaf((count, self.all.half_area()), [(left, l), (count - left, r)]) {
            return Err(self);
        }
        for (side, is_right) in [(before, false), (after, true)] {
            side.iter().for_each(|&i| shared.right[i as usize].store(is_right, Relaxed));
        }
        each(&mut self.axes, |which, other| {
            if which != axis {
                other.part(shared.right);
            }
        });
        let [x, y, z] = self.axes.map(|axis| axis.split_at(left));
        let spare = self.spare.saturating_sub(1);
        let half = |axes, all| Self { axes, all, spare, shared };
        Ok([half([x.0, y.0, z.0], sides[0]), half([x.1, y.1, z.1], sides[1])])
    }

    fn list(&self, order: &mut Vec<u32>) {
        order.extend(self.axes[0].order.iter().map(|&i| self.shared.references[i as usize].primitive()));
    }
}

impl Sweep<'_> {
    /// The cheapest split, as axis and number on the left; the first of several. None without gain.
    fn best(&mut self) -> Option<(usize, usize)> {
        let references = self.shared.references;
        let costs = each(&mut self.axes, |_, axis| axis.best(references));
        // If only rounding decides, median splits are better.
        let unsplit = self.all.half_area() * self.len() as f32;
        let (mut least, mut best) = (unsplit * (1.0 - 8.0 * f32::EPSILON), None);
        for (axis, (cost, left)) in costs.into_iter().enumerate() {
            if cost < least {
                (least, best) = (cost, Some((axis, left)));
            }
        }
        best
    }

    /// The axis of greatest extent of the centers.
    fn longest(&self) -> usize {
        let centre = |axis: usize, i: u32| self.shared.references[i as usize].centre_on(axis);
        let ends = |side: usize| {
            let at = |axis: usize| {
                let order = &self.axes[axis].order;
                centre(axis, order[side * (order.len() - 1)])
            };
            Vec4::new(at(0), at(1), at(2), 0.0)
        };
        Bounds::point(ends(0)).union(&Bounds::point(ends(1))).longest()
    }
}

impl<'a> Axis<'a> {
    /// The cheapest split: its cost, infinite if there is none, and the number on the left.
    fn best(&mut self, references: &[Reference]) -> (f32, usize) {
        let count = self.order.len();
        let bounds = |i: u32| &references[i as usize].bounds;
        // The costs of the right side from each position.
        let mut grown = Bounds::EMPTY;
        for place in (1..count).rev() {
            grown.grow(bounds(self.order[place]));
            self.space[place] = (grown.half_area() * (count - place) as f32).to_bits();
        }
        let (mut least, mut best) = (f32::INFINITY, 0);
        let mut grown = Bounds::EMPTY;
        for place in 1..count {
            grown.grow(bounds(self.order[place - 1]));
            let cost = grown.half_area() * place as f32 + f32::from_bits(self.space[place]);
            if cost < least {
                (least, best) = (cost, place);
            }
        }
        (least, best)
    }

    /// Partition stably into left and right.
    fn part(&mut self, is_right: &[AtomicBool]) {
        let (mut left, mut right) = (0, 0);
        for place in 0..self.order.len() {
            let i = self.order[place];
            let goes_right = is_right[i as usize].load(Relaxed);
            (self.order[left], self.space[right]) = (i, i);
            left += usize::from(!goes_right);
            right += usize::from(goes_right);
        }
        self.order[left..].copy_from_slice(&self.space[..right]);
    }

    fn split_at(self, left: usize) -> (Self, Self) {
        let (order, other_order) = self.order.split_at_mut(left);
        let (space, other_space) = self.space.split_at_mut(left);
        (Self { order, space }, Self { order: other_order, space: other_space })
    }
}

/// Apply a function to each axis, in parallel for large sets.
fn each<T: Send>(axes: &mut [Axis; 3], f: impl Fn(usize, &mut Axis) -> T + Sync) -> [T; 3] {
    let [x, y, z] = axes;
    if x.order.len() < MANY {
        return [f(0, x), f(1, y), f(2, z)];
    }
    let (x, (y, z)) = parallel::join(|| f(0, x), || parallel::join(|| f(1, y), || f(2, z)));
    [x, y, z]
}

fn around(references: &[Reference], order: &[u32]) -> Bounds {
    let grown = |mut bounds: Bounds, &i: &u32| {
        bounds.grow(&references[i as usize].bounds);
        bounds
    };
    if order.len() < MANY {
        return order.iter().fold(Bounds::EMPTY, grown);
    }
    let parts = parallel::map_chunks(order.len(), MANY, |range| order[range].iter().fold(Bounds::EMPTY, grown));
    parts.iter().fold(Bounds::EMPTY, |all, part| all.union(part))
}
