//! The closest hit of a ray so far as an interval of `t`, and comparisons in f64.

use super::node::Packed;
use raywright_base::math::robust::{greater, lesser};
use raywright_base::simd::Lanes;
use raywright_shapes::Candidate;
use raywright_shapes::triangle::{About, EdgeRay, Leaves};

/// The closest hit so far, in the units of leaves ([`Leaves::unit`]).
#[derive(Clone, Copy, Debug)]
pub struct Best {
    /// Its `t` is between `low` and `high`. Initially both surround the ray's end.
    pub low: f32,
    pub high: f32,
    /// The leaf of the triangle; [`Packed::NONE`] without a hit.
    pub leaf: Packed,
    /// The lane of the triangle.
    pub lane: u32,
}

/// Four times the error of rounding to f32.
const ULPS: f32 = 1.0 / (1u32 << 22) as f32;

/// An f64 as an interval of two f32. The lower bound is never +∞, nor the upper one −∞.
// Branchless, unlike the tightest interval.
#[inline(always)]
pub fn between(x: f64) -> (f32, f32) {
    let y = greater(lesser(x as f32, f32::MAX), f32::MIN);
    let room = y.abs() * ULPS + f32::MIN_POSITIVE;
    (y - room, y + room)
}

/// The same for numbers that have already been rounded to f32.
#[inline(always)]
pub fn between_all<const N: usize, S: Lanes<N>>(simd: S, x: S::F32) -> (S::F32, S::F32) {
    let y = simd.max(simd.min(x, simd.splat(f32::MAX)), simd.splat(f32::MIN));
    let room = simd.add(simd.mul(simd.abs(y), simd.splat(ULPS)), simd.splat(f32::MIN_POSITIVE));
    (simd.sub(y, room), simd.add(y, room))
}

impl Best {
    /// No hit, for a ray that ends at `t`.
    #[inline(always)]
    pub fn until(t: f64) -> Self {
        Self { leaf: Packed::NONE, lane: 0, low: 0.0, high: 0.0 }.at(t)
    }

    /// The same hit at a known `t`.
    #[inline(always)]
    fn at(self, t: f64) -> Self {
        let (low, high) = between(t);
        Self { low, high, ..self }
    }

    /// Return whether it is the given triangle.
    #[inline(always)]
    pub fn is<const N: usize, L: Leaves<N>>(&self, leaves: &L, leaf: Packed, lane: u32) -> bool {
        self.leaf != Packed::NONE && primitive(leaves, self.leaf, self.lane) == primitive(leaves, leaf, lane)
    }

    /// Decide in f64 whether a ray hits a triangle closer than its closest hit so far, and update it. At equal `t`, the
    /// lowest primitive wins.
    #[inline(never)]
    pub fn decide<const N: usize, L: Leaves<N>>(
        &mut self,
        leaves: &L,
        unit: f64,
        ray: &EdgeRay,
        leaf: Packed,
        lane: u32,
    ) {
        // Usually nothing else is hit nearby, and `t` is not needed to the last digit.
        match about(leaves, ray, leaf, lane) {
            About::Missed => return,
            About::Between(low, _) if low * unit > f64::from(self.high) => return,
            About::Between(low, high) => {
                let new = Self { low: between(low * unit).0, high: between(high * unit).1, leaf, lane };
                if high * unit < f64::from(self.low) {
                    *self = new;
                    return;
                }
                // For long thin triangles, f32 may know `t` only to a hundredth.
                if self.leaf != Packed::NONE
                    && let About::Between(old_low, old_high) = about(leaves, ray, self.leaf, self.lane)
                {
                    (self.low, self.high) = (between(old_low * unit).0, between(old_high * unit).1);
                    if high < old_low {
                        *self = new;
                    }
                    if high < old_low || low > old_high {
                        return;
                    }
                }
            }
            About::Open => {}
        }
        let Some(new) = meet(leaves, ray, leaf, lane) else { return };
        if self.leaf != Packed::NONE
            && let Some(old) = meet(leaves, ray, self.leaf, self.lane)
            && (old.t, primitive(leaves, self.leaf, self.lane)) <= (new.t, primitive(leaves, leaf, lane))
        {
            *self = self.at(old.t * unit);
            return;
        }
        *self = Self { leaf, lane, ..*self }.at(new.t * unit);
    }
}

/// The index of the triangle in a lane of a leaf.
#[inline(always)]
pub fn primitive<const N: usize, L: Leaves<N>>(leaves: &L, leaf: Packed, lane: u32) -> u32 {
    let (first, count) = leaf.leaf();
    leaves.primitive(first, count, lane as usize & (N - 1))
}

/// Return whether a ray hits the triangle in a lane of a leaf.
#[inline(always)]
pub fn is_met<const N: usize, L: Leaves<N>>(leaves: &L, ray: &EdgeRay, leaf: Packed, lane: u32) -> bool {
    match about(leaves, ray, leaf, lane) {
        About::Missed => false,
        About::Between(..) => true,
        About::Open => meet(leaves, ray, leaf, lane).is_some(),
    }
}

/// Intersect the triangle in a lane of a leaf approximately.
#[inline(always)]
fn about<const N: usize, L: Leaves<N>>(leaves: &L, ray: &EdgeRay, leaf: Packed, lane: u32) -> About {
    let (first, count) = leaf.leaf();
    ray.meet_about(leaves.corners(first, count, lane as usize & (N - 1)))
}

/// Intersect the triangle in a lane of a leaf exactly.
#[inline(always)]
pub fn meet<const N: usize, L: Leaves<N>>(leaves: &L, ray: &EdgeRay, leaf: Packed, lane: u32) -> Option<Candidate> {
    let (first, count) = leaf.leaf();
    ray.meet(leaves.corners(first, count, lane as usize & (N - 1)))
}
