//! The closest point of an implicit surface under an affine map.
//!
//! Branch and bound bisects the box, nearest part first (Land and Doig 1960; with intervals, Moore 1966). A part is
//! discarded if the expression excludes zero or if it is farther than a known point. It is also discarded if the offset
//! from the query point is nowhere normal to the surface there, as it is at a local minimum. Few parts remain at every
//! size. In each, Newton's method on the Lagrange conditions moves a surface point to the stationary one. Where the box
//! cuts the surface open, points on a side of the box only need to be minimal within that side.

use super::Implicit;
use super::jet::Jet;
use crate::{Bounds, gap_under};
use raywright_base::math::robust::UNIT;
use raywright_base::math::{Affine, DVec3, Interval};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Maximum number of parts. Beyond it the best point found is returned, as for the center of a sphere, where all points
/// are equally close.
const WORK: usize = 6000;

/// A part smaller than the box by this factor has a unique closest point, which Newton's method finds.
const SMALL: f64 = 1.0 / (1u32 << 14) as f64;

/// The smallest part on the sides of the box, where bisection alone finds the point.
const LEAST: f64 = 1.0 / (1u64 << 44) as f64;

struct BoxPart {
    bounds: Bounds,
    gap: f64,
}

impl PartialEq for BoxPart {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for BoxPart {}

impl PartialOrd for BoxPart {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for BoxPart {
    /// The nearest is the greatest, and the smallest among equals.
    fn cmp(&self, other: &Self) -> Ordering {
        let size = |part: &Self| (part.bounds.max - part.bounds.min).element_sum();
        other.gap.total_cmp(&self.gap).then(size(other).total_cmp(&size(self)))
    }
}

/// The state of the search.
struct Search<'a> {
    shape: &'a Implicit,
    map: &'a Affine,
    place: DVec3,
    /// The map's columns. Half the squared distance grows along each axis by their dot product with the offset.
    columns: [DVec3; 3],
    /// The closest point found, in object space, and its mapped distance.
    best: Option<(f64, DVec3)>,
}

/// The surface point whose image is closest to a query point, in object space; None if there is no surface.
pub(super) fn closest(shape: &Implicit, map: &Affine, place: DVec3) -> Option<DVec3> {
    let columns = DVec3::AXES.map(|axis| map.vector(axis));
    let mut search = Search { shape, map, place, columns, best: None };
    let whole = shape.bounds;
    let size = whole.max - whole.min;
    let mut parts = BinaryHeap::from([BoxPart { bounds: whole, gap: gap_under(Some(map), &whole, place) }]);
    for work in 0..WORK {
        let Some(part) = parts.pop() else { break };
        if search.best.is_some_and(|(distance, _)| part.gap >= distance) {
            break;
        }
        let bounds = part.bounds;
        let over: [Interval; 3] = std::array::from_fn(|k| Interval::new(bounds.min[k], bounds.max[k]));
        if !shape.tape.value(&over, &mut Vec::new()).contains(0.0) {
            continue;
        }
        let cut = [0, 1, 2].map(|k| side(&whole, &bounds, k));
        let cuts = cut.iter().flatten().count();
        if cuts < 2 && !search.may_hold(&over, cut.iter().position(Option::is_some)) {
            continue;
        }
        let share = ((bounds.max - bounds.min) / size).max_element();
        // Try Newton's method on large parts while that is cheap compared with the rest of the search.
        if share <= 0.25 || work < 8 {
            search.try_from(0.5 * (bounds.min + bounds.max), [None; 3], share <= 0.25);
            if cuts > 0 {
                search.try_from(0.5 * (bounds.min + bounds.max), cut, share <= 0.25);
            }
        }
        if share <= if cuts > 0 { LEAST } else { SMALL } {
            continue;
        }
        let axis = super::Implicit::main_axis((bounds.max - bounds.min) / size);
        let middle = 0.5 * (bounds.min[axis] + bounds.max[axis]);
        if middle <= bounds.min[axis] || middle >= bounds.max[axis] {
            continue;
        }
        let (mut low, mut high) = (bounds, bounds);
        (low.max[axis], high.min[axis]) = (middle, middle);
        for bounds in [low, high] {
            let gap = gap_under(Some(map), &bounds, place).max(part.gap);
            if search.best.is_none_or(|(distance, _)| gap < distance) {
                parts.push(BoxPart { bounds, gap });
            }
        }
    }
    search.best.map(|(_, own)| own)
}

/// The coordinate of the box side that a part touches along an axis, if any.
fn side(whole: &Bounds, part: &Bounds, axis: usize) -> Option<f64> {
    if part.min[axis] <= whole.min[axis] {
        Some(whole.min[axis])
    } else if part.max[axis] >= whole.max[axis] {
        Some(whole.max[axis])
    } else {
        None
    }
}

impl Search<'_> {
    /// The offset from the query point to a point's image.
    fn way(&self, own: DVec3) -> DVec3 {
        // The shift first: it cancels most of a distant query point.
        (self.map.shift - self.place) + self.map.vector(own)
    }

    /// Half the gradient of the squared distance.
    fn pull(&self, own: DVec3) -> DVec3 {
        let way = self.way(own);
        DVec3::from_array(self.columns.map(|column| column.dot(way)))
    }

    /// Return whether a part may hold a local minimum: of the whole surface or, if it touches a side of the box, of
    /// that side.
    fn may_hold(&self, over: &[Interval; 3], cut: Option<usize>) -> bool {
        let mut work = Vec::new();
        let slopes: [Interval; 3] = std::array::from_fn(|axis| {
            let line = std::array::from_fn(|k| Jet::new(over[k], Interval::point(if k == axis { 1.0 } else { 0.0 })));
            self.shape.tape.value(&line, &mut work).slope
        });
        if slopes.iter().any(|slope| slope.is_empty() || !slope.magnitude().is_finite()) {
            return true;
        }
        let shift = self.map.shift - self.place;
        // The offset: intervals do not cover one rounding of its three products and sums.
        let way: [Interval; 3] = std::array::from_fn(|k| {
            let row = self.map.rows[k];
            let parts = (0..3).map(|i| Interval::point(row[i]).times(over[i]));
            let sum = parts.fold(Interval::point(shift[k]), Interval::plus);
            let room = 4.0 * UNIT * (shift[k].abs() + self.place[k].abs() + self.map.shift[k].abs());
            sum.plus(Interval::new(-room, room))
        });
        let pull: [Interval; 3] = std::array::from_fn(|i| {
            let column = self.columns[i];
            let parts = (0..3).map(|k| Interval::point(column[k]).times(way[k]));
            parts.fold(Interval::point(0.0), Interval::plus)
        });
        let is_along = |axis: usize| {
            let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
            slopes[i].times(pull[j]).minus(slopes[j].times(pull[i])).contains(0.0)
        };
        cut.map_or_else(|| (0..3).all(is_along), is_along)
    }

    /// Move a point onto the surface and, if `further`, on to the stationary point of the distance. Coordinates in
    /// `fixed` are kept.
    fn try_from(&mut self, start: DVec3, fixed: [Option<f64>; 3], further: bool) {
        let free = DVec3::from_array(fixed.map(|side| if side.is_none() { 1.0 } else { 0.0 }));
        let mut own = DVec3::from_array([0, 1, 2].map(|k| fixed[k].unwrap_or(start[k])));
        for _ in 0..12 {
            let slope = self.shape.gradient(own).0 * free;
            let step = slope * (self.shape.value(own) / slope.length_squared());
            if !step.is_finite() {
                return;
            }
            own = (own - step).clamp(self.shape.bounds.min, self.shape.bounds.max);
            if step.abs().max_element() <= 2.0 * UNIT * self.shape.extent {
                break;
            }
        }
        self.offer(own, free, false);
        if !further {
            return;
        }
        for _ in 0..16 {
            let Some(step) = self.newton(own, free) else { return };
            let next = (own + step).clamp(self.shape.bounds.min, self.shape.bounds.max);
            let stays = (next - own).abs().max_element() <= 2.0 * UNIT * self.shape.extent;
            own = next;
            if stays {
                break;
            }
        }
        self.offer(own, free, true);
    }

    /// Accept a point on the surface if it is the closest so far. Distances near the minimum are equal to within
    /// rounding, so a converged point (`right`) takes precedence.
    fn offer(&mut self, own: DVec3, free: DVec3, right: bool) {
        let slope = (self.shape.gradient(own).0 * free).length();
        let off = self.shape.value(own).abs() / slope;
        let on = off <= 8.0 * UNIT * self.shape.extent || self.shape.enclosed(own).contains(0.0);
        let distance = self.way(own).length();
        let room = 1.0 + if right { 8.0 * UNIT } else { -8.0 * UNIT };
        if on && distance.is_finite() && self.best.is_none_or(|(best, _)| distance < best * room) {
            self.best = Some((distance, own));
        }
    }

    /// A Newton step along the `free` axes toward the point where the expression is zero and the distance gradient is
    /// parallel to its gradient.
    fn newton(&self, own: DVec3, free: DVec3) -> Option<DVec3> {
        let (slope, pure) = self.shape.gradient(own);
        let (slope, pull) = (slope * free, self.pull(own) * free);
        let times = pull.dot(slope) / slope.length_squared();
        let mixed = |i: usize, j: usize| {
            let (_, bend) = self.shape.along(own, DVec3::AXES[i] + DVec3::AXES[j]);
            0.5 * (bend - pure[i] - pure[j])
        };
        let (xy, yz, zx) = (mixed(0, 1), mixed(1, 2), mixed(2, 0));
        let bends = [[pure.x, xy, zx], [xy, pure.y, yz], [zx, yz, pure.z]];
        let mut rows = [[0.0; 5]; 4];
        for i in 0..3 {
            if free[i] == 0.0 {
                rows[i][i] = 1.0;
                continue;
            }
            for j in (0..3).filter(|&j| free[j] > 0.0) {
                rows[i][j] = self.columns[i].dot(self.columns[j]) - times * bends[i][j];
            }
            (rows[i][3], rows[3][i]) = (-slope[i], slope[i]);
            rows[i][4] = times * slope[i] - pull[i];
        }
        rows[3][4] = -self.shape.value(own);
        let [x, y, z, _] = solved(rows)?;
        Some(DVec3::new(x, y, z))
    }
}

/// Solve four linear equations by Gaussian elimination with partial pivoting; None if they are singular.
fn solved(mut rows: [[f64; 5]; 4]) -> Option<[f64; 4]> {
    for k in 0..4 {
        let largest = (k..4).max_by(|&a, &b| rows[a][k].abs().total_cmp(&rows[b][k].abs()))?;
        rows.swap(k, largest);
        let pivot = rows[k];
        for row in rows.iter_mut().skip(k + 1) {
            let times = row[k] / pivot[k];
            for (x, y) in row.iter_mut().zip(pivot) {
                *x -= times * y;
            }
        }
    }
    let mut found = [0.0; 4];
    for k in (0..4).rev() {
        let known: f64 = (k + 1..4).map(|j| rows[k][j] * found[j]).sum();
        found[k] = (rows[k][4] - known) / rows[k][k];
    }
    found.iter().all(|x| x.is_finite()).then_some(found)
}
