//! Bounds of the part of a triangle inside a box.
//!
//! The triangle is clipped against the box's faces in turn (Sutherland and Hodgman, "Reentrant Polygon Clipping",
//! 1974), in f64.
//!
//! The bound. Let u = 2⁻⁵³. Where a face cuts an edge between two computed corners, the edge fraction errs by 4u of
//! itself. So with coordinates of at most 2, each coordinate of the cut errs by less than 32u. Six faces and the
//! rounding of the triangle's own corners move the outline by less than ε = 200u. The outline may be distorted by that,
//! but it still winds around each point of the triangle farther than ε from it: clipping moves only points beyond a
//! face, and rounding moves points by less than ε. So if the faces are moved 2ε outward, the clipped triangle is within
//! ε of the outline's hull. One ε is for the outline's distance from the triangle, the other for its distance from the
//! triangle's plane. 2⁻⁴⁴ is allowed for that, and once more at the end.

use raywright_base::math::{Aabb, DVec3, Vec3};
use std::array::from_fn;
use std::mem::swap;

/// An upper bound on the outline's error.
const SLACK: f64 = 1.0 / (1u64 << 44) as f64;

/// Clipping n corners by one face leaves at most 3n/2, even if nonconvex: 3, 4, 6, 9, 13, 19, 28.
const MOST: usize = 28;

/// A box around the part of a triangle inside another box. It lies within that box, and is empty only if the
/// intersection is. Coordinates are in box units, where they exceed 2 by a rounding at most
/// ([`Region::to_box`](raywright_base::math::Region::to_box)).
pub fn clipped(corners: [DVec3; 3], to: &Aabb) -> Aabb {
    let (min, max) = (to.min.as_dvec3() - SLACK, to.max.as_dvec3() + SLACK);
    let [mut least, mut greatest] = extremes(&corners);
    if least.cmplt(min).any() || greatest.cmpgt(max).any() {
        if least.cmpgt(max).any() || greatest.cmplt(min).any() {
            return Aabb::EMPTY;
        }
        let mut outlines = [ClippedPolygon { corners: [DVec3::ZERO; MOST], count: 3 }; 2];
        outlines[0].corners[..3].copy_from_slice(&corners);
        let [mut from, mut to] = outlines.each_mut();
        for axis in 0..3 {
            // The whole outline is usually inside a face, which leaves it unchanged.
            if from.corners().iter().any(|p| p[axis] < min[axis]) {
                from.clip(to, |p| p[axis] - min[axis], |p| p[axis] = min[axis]);
                swap(&mut from, &mut to);
            }
            if from.corners().iter().any(|p| p[axis] > max[axis]) {
                from.clip(to, |p| max[axis] - p[axis], |p| p[axis] = max[axis]);
                swap(&mut from, &mut to);
            }
        }
        [least, greatest] = extremes(from.corners());
    }
    let (least, greatest) = (least - SLACK, greatest + SLACK);
    let inner = Aabb {
        min: to.min.max(Vec3::from_array(from_fn(|axis| below(least[axis])))),
        max: to.max.min(Vec3::from_array(from_fn(|axis| above(greatest[axis])))),
    };
    if inner.is_empty() { Aabb::EMPTY } else { inner }
}

/// A lower bound, at most two steps below.
fn below(x: f64) -> f32 {
    (x as f32).next_down()
}

/// An upper bound, at most two steps above.
fn above(x: f64) -> f32 {
    (x as f32).next_up()
}

/// The componentwise minimum and maximum.
fn extremes(points: &[DVec3]) -> [DVec3; 2] {
    points.iter().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[min, max], &p| [min.min(p), max.max(p)])
}

/// The corners of a clipped triangle, in order.
#[derive(Clone, Copy)]
struct ClippedPolygon {
    corners: [DVec3; MOST],
    count: usize,
}

impl ClippedPolygon {
    fn corners(&self) -> &[DVec3] {
        &self.corners[..self.count]
    }

    /// Clip to the half-space of nonnegative `height`; `level` moves a point exactly to height 0.
    #[inline(always)]
    fn clip(&self, to: &mut Self, height: impl Fn(DVec3) -> f64, level: impl Fn(&mut DVec3)) {
        to.count = 0;
        let mut push = |p| {
            to.corners[to.count] = p;
            to.count += 1;
        };
        let Some(&(mut from)) = self.corners().last() else { return };
        let mut start = height(from);
        for &p in self.corners() {
            let end = height(p);
            if (start >= 0.0) != (end >= 0.0) {
                let mut cut = from + (p - from) * (start / (start - end));
                level(&mut cut);
                push(cut);
            }
            if end >= 0.0 {
                push(p);
            }
            (from, start) = (p, end);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn coordinate() -> impl Strategy<Value = f64> {
        prop_oneof![
            -2.0..2.0f64,
            (-4i32..=4).prop_map(|x| f64::from(x) / 2.0),
            (-4i32..=4, -3i32..=3).prop_map(|(x, k)| f64::from(x) / 2.0 + f64::from(k) * f64::EPSILON),
            (-1f64..1.0, 0i32..60).prop_map(|(x, e)| x * 2f64.powi(-e)),
        ]
    }

    fn point() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(coordinate()).prop_map(DVec3::from_array)
    }

    fn a_box() -> impl Strategy<Value = Aabb> {
        [point(), point()].prop_map(|[a, b]| Aabb { min: a.min(b).as_vec3(), max: a.max(b).as_vec3() })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(3000))]
        #[test]
        fn all_that_is_in_both_is_kept(
            corners in [point(), point(), point()], to in a_box(),
            weights in prop::collection::vec((0u32..=1 << 20, 0u32..=1 << 20), 50),
        ) {
            let kept = clipped(corners, &to);
            prop_assert!(kept == Aabb::EMPTY || to.contains(&kept));
            // Points of the triangle with exact dyadic weights, so that they err by roundings alone.
            for (s, t) in weights {
                let (s, t) = if s + t > 1 << 20 { ((1 << 20) - s, (1 << 20) - t) } else { (s, t) };
                let [a, b, c] = [(1 << 20) - s - t, s, t].map(|w| f64::from(w) / f64::from(1 << 20));
                let p = corners[0] * a + corners[1] * b + corners[2] * c;
                if p.cmpge(to.min.as_dvec3()).all() && p.cmple(to.max.as_dvec3()).all() {
                    let is_kept = p.cmpge(kept.min.as_dvec3()).all() && p.cmple(kept.max.as_dvec3()).all();
                    prop_assert!(is_kept, "{p} of {to:?}: {kept:?}");
                }
            }
        }

        #[test]
        fn halves_make_up_the_whole(corners in [point(), point(), point()], axis in 0usize..3, at in coordinate()) {
            let at = at as f32;
            let everything = Aabb { min: Vec3::splat(-3.0), max: Vec3::splat(3.0) };
            let (mut left, mut right) = (everything, everything);
            (left.max[axis], right.min[axis]) = (at, at);
            let [whole, left, right] = [everything, left, right].map(|part| clipped(corners, &part));
            prop_assert!(whole.contains(&left) && whole.contains(&right));
            prop_assert_eq!(left.union(right), whole);
        }
    }

    #[test]
    fn a_diagonal_is_cut_to_what_is_there() {
        // A thin triangle along a diagonal, clipped to an eighth of a box.
        let corners = [DVec3::ZERO, DVec3::ONE, DVec3::new(1.0, 1.0, 0.999)];
        let to = Aabb { min: Vec3::new(0.25, 0.0, 0.0), max: Vec3::new(0.5, 1.0, 1.0) };
        let kept = clipped(corners, &to);
        let wanted = Aabb { min: Vec3::new(0.25, 0.25, 0.24975), max: Vec3::splat(0.5) };
        assert!(
            (kept.min - wanted.min).abs().max_element() < 1e-6 && (kept.max - wanted.max).abs().max_element() < 1e-6
        );
        let beside = Aabb { min: Vec3::new(0.25, 0.6, 0.0), max: Vec3::new(0.5, 1.0, 1.0) };
        assert_eq!(clipped(corners, &beside), Aabb::EMPTY);
    }
}
