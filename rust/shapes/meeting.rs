//! How a shape that is bounded by planes and quadrics meets a line, decided without error.

use super::line::{Carried, Line};
use super::{Candidate, Contact};
use crate::math::{Bounded, DVec3, Double, Dyadic, Number};
use std::cmp::Ordering;

/// Where a line meets a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Meet {
    /// Along the line: within an ulp.
    pub t: f64,
    /// Which part of the shape it meets, counted as the shape likes.
    pub part: usize,
    /// How.
    pub contact: Contact,
}

/// Up to two of them, by increasing `t`.
pub(super) type Meets = [Option<Meet>; 2];

/// A shape that can tell in any numbers where a line meets it.
pub(super) trait Solid {
    /// Where, or none where the numbers' errors leave that open.
    fn meets<N: Number>(&self, line: &Line<N>) -> Option<Meets>;

    /// The coordinates of a point of a part, given as nearly as f64 can relative to [`Solid::reference`].
    fn coordinates(&self, part: usize, point: DVec3) -> [f64; 2];

    /// A point of the shape that others are told relative to, so that far from the origin digits are kept.
    fn reference(&self) -> DVec3;
}

/// Tells the meetings of a solid with a ray, as [`super::Shape::meet`] does.
///
/// An f64 suffices for most misses. All else is computed at twice the length, from which `t` is rounded once, and what that
/// leaves open is computed without any error.
pub(super) fn tell(solid: &impl Solid, ray: &Carried<'_>, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
    if !ray.is_line() {
        return false;
    }
    let found = solid
        .meets(&ray.line::<Bounded>())
        .or_else(|| solid.meets(&ray.line::<Double>()))
        .or_else(|| solid.meets(&ray.line::<Dyadic>()))
        .unwrap_or_default();
    if found[0].is_none() {
        return false;
    }
    let (t_min, t_max) = (ray.ray().t_min, ray.ray().t_max);
    let mut line = None;
    for Meet { t, part, contact } in found.into_iter().flatten() {
        // What lies further along than f64 can say is not met.
        if t.is_finite() && t_min <= t && t <= t_max {
            let line = line.get_or_insert_with(|| ray.line::<Double>().from(solid.reference()));
            let uv = solid.coordinates(part, line.at(t));
            if met(Candidate { t, uv, contact, inner: 0 }) {
                return true;
            }
        }
    }
    false
}

/// Two meetings of a convex solid, the ends of the segment within; one that is only touched if they are the same.
pub(super) fn ends(near: (f64, usize), far: (f64, usize)) -> Meets {
    let meet = |(t, part), contact| Some(Meet { t, part, contact });
    if near.0 == far.0 {
        [meet(near, Contact::Touching), None]
    } else {
        [meet(near, Contact::Inside), meet(far, Contact::Inside)]
    }
}

/// The roots of `a t² + 2 b t + c`, the lesser first, where `b² − a c` is `discriminant` > 0 and `a` is not 0.
///
/// Of the two formulas for each, that is used which subtracts nothing (Goldberg 1991).
pub(super) fn roots<N: Number>(a: &N, b: &N, c: &N, discriminant: &N) -> Option<[N; 2]> {
    let root = discriminant.sqrt();
    let negative = b.seems_negative();
    let q = if negative { root.minus(b) } else { root.plus(b).negated() };
    let (first, second) = (q.over(a), c.over(&q));
    let first_is_less = (a.sign()? == Ordering::Greater) != negative;
    Some(if first_is_less { [first, second] } else { [second, first] })
}

/// Where a line from a ball's centre meets the ball: |origin + t · direction| = radius.
pub(super) fn ball<N: Number>(line: &Line<N>, radius: &N) -> Option<Meets> {
    let (w, d) = (&line.origin, &line.direction);
    let a = d.dot(d);
    // r² d² − |w × d|² = d² (r² − h²), with h the least distance of the line from the centre: what b² − a c is, without its
    // cancellation (Haines et al., "Precision Improvements for Ray/Sphere Intersection", 2019).
    let moment = w.cross(d);
    let discriminant = radius.squared().times(&a).minus(&moment.dot(&moment));
    let b = w.dot(d);
    match discriminant.sign()? {
        Ordering::Less => Some(Meets::default()),
        Ordering::Equal => {
            let t = b.over(&a).negated().rounded()?;
            Some(ends((t, 0), (t, 0)))
        }
        Ordering::Greater => {
            let c = w.dot(w).minus(&radius.squared());
            // Of what lies on it, c is zero exactly, and that is known of exact numbers alone.
            c.sign()?;
            let [near, far] = roots(&a, &b, &c, &discriminant)?;
            Some(ends((near.rounded()?, 0), (far.rounded()?, 0)))
        }
    }
}
