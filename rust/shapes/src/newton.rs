//! Newton refinement of an intersection from a few digits to full f64 precision.

use super::line::Carried;
use super::solid::{Meet, Solid};
use raywright_base::math::Bounded;
use raywright_base::math::robust::UNIT;

/// Relative distance from a tie between two f64 within which either neighbor may be returned.
const NEAR: f64 = 1.0 / (1u64 << 60) as f64;

/// Allowance for the roundings of the bounds.
const SLACK: f64 = 1.0 + 1.0 / (1u64 << 40) as f64;

/// The f64 nearest to the intersection of a line with a surface; None if the bounds cannot guarantee it.
///
/// This is Newton's method with the polynomial f in double-double arithmetic and all else in f64. Let S be the slope at
/// the root, a half the second derivative, and ε the distance of the start from the root. Then f = ε (S + a ε) exactly.
/// The step errs by at most the errors of f and S, which have known bounds, and by a ε. One step suffices except for
/// roots near 0, where the relative error remains large.
#[inline(always)]
pub(super) fn refined(solid: &impl Solid, ray: &Carried<'_>, meet: &Meet<Bounded>) -> Option<f64> {
    let (mut t, mut reach) = (meet.t.value, meet.t.error);
    let (slope, bend) = (meet.slope, meet.bend.value.abs() + meet.bend.error);
    for _ in 0..3 {
        let (point, unit) = ray.at(t, solid.reference());
        let f = solid.surface(meet.surface, &point, &unit);
        let wander = (slope.error + bend * reach) * SLACK;
        let least = slope.value.abs() - wander;
        // Also rejects NaN.
        if !(least > 0.0 && t.is_finite()) {
            return None;
        }
        let step = f.high / slope.value;
        let off = (f.error + step.abs() * wander) / least * SLACK + 4.0 * UNIT * step.abs();
        let next = t - step;
        if off <= NEAR * next.abs() {
            // Turn −0 into +0.
            return Some(next + 0.0);
        }
        (t, reach) = (next, off + UNIT * next.abs());
    }
    None
}
