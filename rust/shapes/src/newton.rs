//! Roots of a surface along a line, from some digits of them to all.

use super::line::Carried;
use super::solid::{Meet, Solid};
use raywright_base::math::Bounded;
use raywright_base::math::robust::UNIT;

/// How near to a tie between two f64 the last one may be the wrong one of them, relative.
const NEAR: f64 = 1.0 / (1u64 << 60) as f64;

/// Room for the roundings of the bounds.
const SLACK: f64 = 1.0 + 1.0 / (1u64 << 40) as f64;

/// The f64 next to where a line meets a surface; none where the bounds do not make that certain.
///
/// Newton's step, with the polynomial f at twice the length and all else in f64. With S the slope at the root, a half
/// the second derivative and ε the distance of the start from the root, f = ε (S + a ε) there, exactly: so the step
/// errs by no more than f and S are wrong, each by a bound that is known, and by a ε. Once is enough but for roots next
/// to 0, where one that is nearer is as far off as it is large.
#[inline(always)]
pub(super) fn refined(solid: &impl Solid, ray: &Carried<'_>, meet: &Meet<Bounded>) -> Option<f64> {
    let (mut t, mut reach) = (meet.t.value, meet.t.error);
    let (slope, bend) = (meet.slope, meet.bend.value.abs() + meet.bend.error);
    for _ in 0..3 {
        let (point, unit) = ray.at(t, solid.reference());
        let f = solid.surface(meet.surface, &point, &unit);
        let wander = (slope.error + bend * reach) * SLACK;
        let least = slope.value.abs() - wander;
        // NaN is not above 0, and nothing is less than it.
        if !(least > 0.0 && t.is_finite()) {
            return None;
        }
        let step = f.high / slope.value;
        let off = (f.error + step.abs() * wander) / least * SLACK + 4.0 * UNIT * step.abs();
        let next = t - step;
        if off <= NEAR * next.abs() {
            // Zero is always the positive one.
            return Some(next + 0.0);
        }
        (t, reach) = (next, off + UNIT * next.abs());
    }
    None
}
