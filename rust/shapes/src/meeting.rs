//! Exact intersection of a line with a solid bounded by planes and quadrics.

use super::line::{Carried, Line};
use super::newton::refined;
use super::solid::{Meet, Meets, Solid};
use super::{Candidate, Contact};
use raywright_base::math::{Bounded, Double, Dyadic, Number, Ray, Triple};
use std::cmp::Ordering;

/// Report the intersections of a solid with a ray, as [`super::Shape::meet`] does.
///
/// In nearly all cases f64 with error bounds decides what is hit and in which order. Each `t` is then refined by
/// evaluating the surface polynomial in double-double arithmetic ([`refined`]). Undecided cases are computed in
/// double-double throughout, and then exactly. All three return the f64 nearest to the exact `t`, except within 2⁻⁶⁰ of
/// a tie, and the choice among them depends only on shape and line.
#[inline(always)]
pub(super) fn tell(solid: &impl Solid, ray: &Carried<'_>, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
    if !ray.is_line() {
        return false;
    }
    match ray {
        // Specialized: with a unit of 1 and no map, much of the code is eliminated.
        Carried::Ray(ray) => tell_of_line(solid, &Carried::Ray(ray), met),
        Carried::Into(..) => tell_of_line(solid, ray, met),
    }
}

#[inline(always)]
fn tell_of_line(solid: &impl Solid, ray: &Carried<'_>, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
    // By reference, since a list of intersections takes some hundred bytes.
    let known = match &solid.meets_roughly(ray) {
        Some(meets) if meets.count == 0 => return false,
        Some(meets) => tell_refined(solid, ray, meets, met),
        None => Err(0),
    };
    known.unwrap_or_else(|told| tell_exactly(solid, ray, told, met))
}

/// Report the intersections that f64 decides. On failure return how many were processed.
#[inline(always)]
fn tell_refined(
    solid: &impl Solid,
    ray: &Carried<'_>,
    meets: &Meets<Bounded>,
    met: &mut dyn FnMut(Candidate) -> bool,
) -> Result<bool, usize> {
    let &Ray { t_min, t_max, .. } = ray.ray();
    let [Some(first), second, None, _] = &meets.all else { return Err(0) };
    let (mut first, mut second) = (first, second.as_ref());
    let touched = meets.closed && second.is_none();
    if let Some(second) = &mut second {
        // Their distance exceeds their errors and the roundings to come, each at most one error, so the rounded values
        // differ too.
        let (gap, room) = (second.t.value - first.t.value, 4.0 * (first.t.error + second.t.error));
        if gap < -room {
            std::mem::swap(&mut first, second);
        } else if gap.is_nan() || gap <= room {
            return Err(0);
        }
    }
    let mut tell_one = |meet: &Meet<Bounded>, told: usize| {
        // Usually at most the first intersection is in the interval; the others need no refinement.
        let room = 4.0 * meet.t.error;
        if meet.t.value - room > t_max || meet.t.value + room < t_min {
            return Ok(false);
        }
        let t = refined(solid, ray, meet).ok_or(told)?;
        if !(t.is_finite() && t_min <= t && t <= t_max) {
            return Ok(false);
        }
        let contact = if touched { Contact::Touching } else { meet.contact };
        let uv = solid.coordinates(meet.part, ray.point(t, solid.reference()));
        Ok(met(Candidate { t, uv, contact, inner: 0 }))
    };
    match second {
        Some(second) => Ok(tell_one(first, 0)? || tell_one(second, 1)?),
        None => tell_one(first, 0),
    }
}

/// Report the intersections in longer arithmetic, skipping the first `told`.
#[cold]
#[inline(never)]
fn tell_exactly(solid: &impl Solid, ray: &Carried<'_>, told: usize, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
    let found = solid
        .meets(&ray.line::<Double>())
        .and_then(settled)
        .or_else(|| solid.meets(&ray.line::<Dyadic>()).and_then(settled))
        .unwrap_or_default();
    let (t_min, t_max) = (ray.ray().t_min, ray.ray().t_max);
    for (t, part, contact) in found.into_iter().flatten().skip(told) {
        // Discard intersections beyond the range of f64.
        if t.is_finite() && t_min <= t && t <= t_max {
            let uv = solid.coordinates(part, ray.point(t, solid.reference()));
            if met(Candidate { t, uv, contact, inner: 0 }) {
                return true;
            }
        }
    }
    false
}

/// `t`, part and contact of up to two intersections by increasing `t`, or None if their errors leave one undecided.
fn settled<N: Number>(meets: Meets<N>) -> Option<[Option<(f64, usize, Contact)>; 2]> {
    let mut all = [(0.0, 0, Contact::Inside); 4];
    for (to, meet) in all.iter_mut().zip(meets.all.iter().flatten()) {
        // Turn −0 into +0.
        *to = (meet.t.rounded()? + 0.0, meet.part, meet.contact);
    }
    let all = &mut all[..meets.count];
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    Some(match *all {
        [] => [None; 2],
        // The line is tangent if both ends coincide.
        [first, .., last] if meets.closed && first.0 != last.0 => [Some(first), Some(last)],
        [(t, part, _), ..] if meets.closed => [Some((t, part, Contact::Touching)), None],
        [only] => [Some(only), None],
        [first, second, ..] => [Some(first), Some(second)],
    })
}

/// A root along a line and its derivative.
#[derive(Clone)]
pub(super) struct Root<N> {
    /// The root.
    pub t: N,
    /// The derivative.
    pub slope: N,
}

/// The roots of `a t² + 2 b t + c` in increasing order, given `discriminant` = `b² − a c` > 0 and `a` ≠ 0.
///
/// Each root uses the formula without cancellation (Goldberg 1991).
#[inline(always)]
pub(super) fn roots<N: Number>(a: &N, b: &N, c: &N, discriminant: &N) -> Option<[Root<N>; 2]> {
    let root = discriminant.sqrt();
    let negative = b.seems_negative();
    let q = if negative { root.minus(b) } else { root.plus(b).negated() };
    let (first, second) = (q.over(a), c.over(&q));
    let rises = a.sign()? == Ordering::Greater;
    let [less, greater] = if rises != negative { [first, second] } else { [second, first] };
    // Half the derivative, a t + b, equals ± the square root of the discriminant.
    let (up, down) = (root.plus(&root), root.plus(&root).negated());
    let (less_slope, greater_slope) = if rises { (down, up) } else { (up, down) };
    Some([Root { t: less, slope: less_slope }, Root { t: greater, slope: greater_slope }])
}

/// Intersect a line relative to a sphere's center with the sphere: |origin + t · direction| = radius.
#[inline(always)]
pub(super) fn ball<N: Number>(line: &Line<N>, radius: &N) -> Option<Meets<N>> {
    let (w, d) = (&line.origin, &line.direction);
    let a = d.dot(d);
    // r² d² − |w × d|² = d² (r² − h²), with h the distance of the line from the center. It equals b² − a c without its
    // cancellation (Haines et al., "Precision Improvements for Ray/Sphere Intersection", 2019).
    let moment = w.cross(d);
    let square = radius.squared();
    let discriminant = square.times(&a).minus(&moment.dot(&moment));
    let meet = |Root { t, slope }| Meet { t, slope, bend: a.clone(), surface: 0, part: 0, contact: Contact::Inside };
    match discriminant.sign()? {
        Ordering::Less => Some(Meets::new(true)),
        Ordering::Equal => {
            let t = w.dot(d).over(&a).negated();
            Some(Meets::new(true).with(meet(Root { t, slope: N::of(0.0) })))
        }
        Ordering::Greater => {
            let c = w.dot(w).minus(&square);
            let [near, far] = roots(&a, &w.dot(d), &c, &discriminant)?;
            Some(Meets::new(true).with(meet(near)).with(meet(far)))
        }
    }
}

/// The implicit function of a sphere around the origin.
#[inline(always)]
pub(super) fn ball_surface<N: Number>(point: &Triple<N>, radius: &N) -> N {
    point.dot(point).minus(&radius.squared())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cuboid, Disk, Ellipsoid, Plane, Revolution, Sphere};
    use proptest::prelude::*;
    use raywright_base::math::{Affine, DVec3};

    type Told = Vec<(u64, [u64; 2], Contact)>;

    fn told(tell: impl FnOnce(&mut dyn FnMut(Candidate) -> bool) -> bool) -> Told {
        let mut told = Vec::new();
        tell(&mut |met| {
            told.push((met.t.to_bits(), met.uv.map(f64::to_bits), met.contact));
            false
        });
        told
    }

    /// Fail unless the fast and the exact method agree to the last bit, except at ties. Return whether f64 was certain.
    fn check(solid: &impl Solid, ray: &Carried<'_>) -> Result<bool, TestCaseError> {
        let exact = told(|met| tell_exactly(solid, ray, 0, met));
        let known = solid.meets_roughly(ray);
        if known.is_some_and(|meets| meets.count == 0) {
            prop_assert_eq!(&exact, &Told::new(), "{:?}", ray);
        }
        let found = told(|met| tell(solid, ray, met));
        prop_assert_eq!(found.len(), exact.len(), "{:?}", ray);
        for (f, e) in found.iter().zip(&exact) {
            // At a tie either neighbor may be returned: 1 + 2⁻⁵³ + 2⁻¹⁰⁶ is a quotient of neighbors.
            prop_assert!(f == e || (f.0.abs_diff(e.0) == 1 && f.2 == e.2), "{f:?} {e:?} {ray:?}");
        }
        let sure = known.is_some_and(|meets| tell_refined(solid, ray, &meets, &mut |_| false).is_ok());
        Ok(sure || known.is_some_and(|meets| meets.count == 0))
    }

    /// Check all solids of one size at one place.
    fn check_all(a: DVec3, axis: DVec3, size: f64, ray: &Carried<'_>) -> Result<u32, TestCaseError> {
        // Skip combinations that overflow or give no valid shape or line.
        if !(ray.is_line() && a.is_finite() && (a + axis).is_finite() && size.is_finite() && size > 0.0) {
            return Ok(0);
        }
        let (b, shapes) = (a + axis, DVec3::new(1.0, 0.5, 2.0) * size);
        let mut sure = u32::from(check(&Sphere { center: a, radius: size }, ray)?);
        sure += u32::from(check(&Ellipsoid { center: a, semi_axes: shapes }, ray)?);
        sure += u32::from(check(&Cuboid { min: a.min(b), max: a.max(b) }, ray)?);
        if axis != DVec3::ZERO {
            sure += u32::from(check(&Plane { point: a, normal: axis }, ray)?);
            sure += u32::from(check(&Disk { center: a, normal: axis, radius: size, inner_radius: size / 4.0 }, ray)?);
        }
        if a != b {
            for capped in [true, false] {
                sure += u32::from(check(&Revolution::cylinder(a, b, size, capped), ray)?);
                sure += u32::from(check(&Revolution::cone(a, b, [size, size / 2.0], capped), ray)?);
                sure += u32::from(check(&Revolution::paraboloid(a, b, size, capped), ray)?);
            }
        }
        Ok(sure)
    }

    fn point() -> impl Strategy<Value = DVec3> {
        let any = |size: f64| prop::array::uniform3(-size..size).prop_map(DVec3::from_array);
        let grid = prop::array::uniform3(-2i32..=2).prop_map(|p| DVec3::from_array(p.map(f64::from)));
        prop_oneof![any(3.0), grid, any(1e-4), any(1e4)]
    }

    /// 1, and sometimes a power of two for which squares or products of four overflow or underflow.
    fn extreme() -> impl Strategy<Value = f64> {
        prop_oneof![Just(0), -60..60i32, -1000..1000i32].prop_map(|power| 2f64.powi(power))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1500))]

        #[test]
        fn short_numbers_tell_what_long_ones_do(
            a in point(), axis in point(), size in prop_oneof![0.01..3.0f64, Just(1.0), Just(2.0)],
            o in point(), target in point(),
            (space, length, own) in (extreme(), extreme(), extreme()), close in -52..2i32,
        ) {
            // Past the rim by any fraction of the size, too.
            let d = a + target.normalize_or_zero() * size * (1.0 + 2f64.powi(close)) - o;
            for d in [d, a + target - o] {
                let ray = Ray { t_min: f64::NEG_INFINITY, ..Ray::new(o * space, d * space * length) };
                check_all(a * space, axis * space, size * space, &Carried::Ray(&ray))?;
                // Shapes whose size differs from their distance.
                check_all(a * space, axis * own, size * own, &Carried::Ray(&ray))?;
                let map = Affine::new([DVec3::new(2.0, 0.3, 0.0), DVec3::new(-0.5, 1.0, 0.1), DVec3::Z], DVec3::ONE);
                check_all(a * space, axis * space, size * space, &Carried::Into(&Carried::Ray(&ray), &map))?;
            }
        }
    }

    /// f64 decides all of a thousand generic lines.
    #[test]
    fn most_lines_need_no_long_numbers() {
        let mut sure = 0;
        for i in 0..1000 {
            let (sin, cos) = (f64::from(i) * 0.7).sin_cos();
            let origin = DVec3::new(4.0 * cos, 4.0 * sin, 2.1 + 1e-4 * f64::from(i));
            let target = DVec3::new(0.3 + sin * 0.61, 0.2 - cos * 0.53, 0.7);
            let ray = Ray::new(origin, target - origin);
            sure += check_all(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.4, 0.3, 1.1), 0.8, &Carried::Ray(&ray)).unwrap();
        }
        assert_eq!(sure, 11 * 1000);
    }
}
