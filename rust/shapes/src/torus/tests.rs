use super::*;
use crate::Contact;
use num_bigint::BigInt;
use proptest::prelude::*;
use raywright_base::sampling::Sampler;
use raywright_base::sampling::chi_square::assert_frequencies;

/// A polynomial, lowest coefficient first.
type Poly = Vec<BigInt>;

/// `x · 2^300` as an integer.
fn integer(x: f64) -> BigInt {
    let bits = x.to_bits();
    if x == 0.0 {
        return BigInt::ZERO;
    }
    let shift = ((bits >> 52) & 0x7ff) as i32 - 1075 + 300;
    let mantissa = BigInt::from((bits & ((1 << 52) - 1)) | 1 << 52);
    let value = if shift >= 0 { mantissa << shift as usize } else { mantissa >> (-shift) as usize };
    if x < 0.0 { -value } else { value }
}

fn product(a: &Poly, b: &Poly) -> Poly {
    let mut all = vec![BigInt::ZERO; a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            all[i + j] += x * y;
        }
    }
    all
}

fn combine(a: &Poly, b: &Poly, times: &BigInt) -> Poly {
    let zero = BigInt::ZERO;
    (0..a.len().max(b.len())).map(|i| a.get(i).unwrap_or(&zero) + times * b.get(i).unwrap_or(&zero)).collect()
}

/// The exact quartic whose roots are the intersections of the ray with the torus.
fn quartic(centre: DVec3, axis: DVec3, major: f64, minor: f64, ray: &Ray) -> Poly {
    let [c, a, o, d] = [centre, axis, ray.origin, ray.direction].map(|v| v.to_array().map(integer));
    let coordinates: Vec<Poly> = (0..3).map(|i| vec![&o[i] - &c[i], d[i].clone()]).collect();
    let one = BigInt::from(1);
    let square = coordinates.iter().fold(vec![BigInt::ZERO], |sum, x| combine(&sum, &product(x, x), &one));
    let height = (0..3).fold(vec![BigInt::ZERO], |sum, i| combine(&sum, &coordinates[i], &a[i]));
    let length = a.iter().fold(BigInt::ZERO, |sum, x| sum + x * x);
    let (major, minor) = (integer(major), integer(minor));
    let whole = combine(&square, &vec![&major * &major - &minor * &minor], &one);
    // (|p|² + R² − r²)² a·a − 4R² (|p|² a·a − (p·a)²).
    let across = combine(&product(&square, &vec![length.clone()]), &product(&height, &height), &BigInt::from(-1));
    combine(&product(&product(&whole, &whole), &vec![length]), &across, &(&major * &major * -4))
}

fn trimmed(mut p: Poly) -> Poly {
    while p.last().is_some_and(|x| *x == BigInt::ZERO) {
        p.pop();
    }
    p
}

/// The Sturm chain, with each remainder scaled by a positive number to stay in integers.
fn chain(p: Poly) -> Vec<Poly> {
    let derivative: Poly = p.iter().enumerate().skip(1).map(|(i, x)| x * i).collect();
    let mut all = vec![trimmed(p), trimmed(derivative)];
    while all[all.len() - 1].len() > 1 {
        let (mut rest, by) = (all[all.len() - 2].clone(), all[all.len() - 1].clone());
        while rest.len() >= by.len() {
            let (lead, shift) = (rest[rest.len() - 1].clone(), rest.len() - by.len());
            let divisor = &by[by.len() - 1];
            let size: BigInt = divisor.magnitude().clone().into();
            let signed = if *divisor < BigInt::ZERO { -lead } else { lead };
            rest = rest.iter().map(|x| x * &size).collect();
            for (i, x) in by.iter().enumerate() {
                rest[i + shift] -= x * &signed;
            }
            rest = trimmed(rest);
        }
        if rest.is_empty() {
            break;
        }
        all.push(rest.iter().map(|x| -x).collect());
    }
    all
}

fn changes(signs: impl Iterator<Item = i32>) -> usize {
    let signs: Vec<i32> = signs.filter(|&s| s != 0).collect();
    signs.windows(2).filter(|w| w[0] != w[1]).count()
}

fn sign(x: &BigInt) -> i32 {
    x.cmp(&BigInt::ZERO) as i32
}

/// The sign of a polynomial at `t`.
fn sign_at(p: &Poly, t: f64) -> i32 {
    let (top, mut sum) = (p.len() - 1, BigInt::ZERO);
    let t = integer(t);
    for (i, x) in p.iter().enumerate().rev() {
        sum = sum * &t + (x << (300 * (top - i)));
    }
    sign(&sum)
}

/// The number of distinct real roots.
fn count(chain: &[Poly]) -> usize {
    let at = |p: &Poly, up: bool| sign(&p[p.len() - 1]) * if up || p.len() % 2 == 1 { 1 } else { -1 };
    changes(chain.iter().map(|p| at(p, false))) - changes(chain.iter().map(|p| at(p, true)))
}

/// The number of roots in (`low`, `high`].
fn between(chain: &[Poly], low: f64, high: f64) -> usize {
    changes(chain.iter().map(|p| sign_at(p, low))) - changes(chain.iter().map(|p| sign_at(p, high)))
}

fn hits(shape: &dyn Shape, ray: &Ray) -> Vec<Candidate> {
    let mut all = Vec::new();
    shape.meet(ray, &mut |met| {
        all.push(met);
        false
    });
    all
}

fn line(origin: DVec3, direction: DVec3) -> Ray {
    Ray { t_min: f64::NEG_INFINITY, ..Ray::new(origin, direction) }
}

/// Fail unless the intersections agree with the exact quartic's roots in number and position.
fn agree(centre: DVec3, axis: DVec3, major: f64, minor: f64, ray: &Ray) -> Result<usize, TestCaseError> {
    let torus = Torus::new(centre, axis, major, minor).unwrap();
    let found = hits(&torus, ray);
    let exact = chain(quartic(centre, axis, major, minor, ray));
    prop_assert_eq!(found.len(), count(&exact), "{:?}", found);
    prop_assert_eq!(found.iter().filter(|m| m.contact != Contact::Touching).count() % 2, 0);
    // In units of t: an ulp of t, plus 2⁻⁸⁰ of the torus's size along the direction. A change of G by 2⁻⁹⁶ moves each
    // of two adjacent roots by its square root, 2⁻⁴⁸.
    let unit = major / ray.direction.length();
    for (i, met) in found.iter().enumerate() {
        let alone = found.iter().enumerate().all(|(j, other)| i == j || (other.t - met.t).abs() > 1e-4 * unit);
        let room = met.t.abs() * f64::EPSILON + unit * 2f64.powi(if alone { -80 } else { -48 });
        prop_assert!(between(&exact, met.t - room, met.t + room) >= 1, "{:?}", met);
    }
    prop_assert!(found.windows(2).all(|w| w[0].t <= w[1].t));
    Ok(found.len())
}

fn vector() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from_array).prop_filter("long", |d| d.length() > 0.1)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]
    #[test]
    fn roots_are_those_of_the_exact_quartic(
        centre in vector(), axis in vector(), minor in prop_oneof![0.01..1.0f64, Just(1.0), Just(1e-5)],
        from in vector(), target in vector(), far in prop_oneof![Just(3.0), Just(1e4), Just(1e8)],
    ) {
        let origin = from * far;
        agree(centre, axis, 1.0, minor, &line(origin, target * 1.5 - origin))?;
    }

    #[test]
    fn near_tangents_are_told_apart(
        axis in vector(), minor in 0.01..0.9f64, u in 0.0..1.0f64, v in 0.0..1.0f64, turn in 0.0..6.3f64,
        off in prop_oneof![Just(0.0), -1e-6..1e-6f64, -1e-12..1e-12f64, -1e-15..1e-15f64],
        far in prop_oneof![Just(0.0), Just(1.0), Just(1e7)],
    ) {
        // A direction in the tangent plane of a point near the surface.
        let torus = Torus::new(DVec3::ZERO, axis, 1.0, minor).unwrap();
        let point = torus.point_at([u, v]);
        let [a, b] = point.dp.map(DVec3::normalize);
        let direction = a * turn.cos() + b * turn.sin();
        agree(DVec3::ZERO, axis, 1.0, minor, &line(point.position + point.normal * off - direction * far, direction))?;
    }

    #[test]
    fn integers_touch_exactly(d in [-4i32..=4, -4..=4, -4..=4], o in [-6i32..=6, -6..=6, -2..=2], minor in 1i32..=4) {
        prop_assume!(d != [0; 3]);
        let [o, d] = [o, d].map(|v| DVec3::from_array(v.map(f64::from)));
        agree(DVec3::new(0.0, 0.0, 1.0), DVec3::Z * 3.0, 4.0, f64::from(minor), &line(o, d))?;
    }

    #[test]
    fn starts_on_the_surface_and_any_size(
        axis in vector(), u in 0.0..1.0f64, v in 0.0..1.0f64, d in vector(), size in -400i32..400,
        length in -90i32..90,
    ) {
        let (size, length) = (2f64.powi(size), 2f64.powi(length));
        let torus = Torus::new(axis * size, axis, size, 0.3 * size).unwrap();
        let small = Torus::new(axis, axis, 1.0, 0.3).unwrap();
        let start = small.point_at([u, v]).position;
        let (big, unit) = (hits(&torus, &line(start * size, d * length)), hits(&small, &line(start, d)));
        prop_assert_eq!(big.len(), unit.len());
        for (a, b) in big.iter().zip(&unit) {
            prop_assert_eq!((a.t * length / size, a.contact), (b.t, b.contact));
            let point = small.point(&line(start, d), b.t, b.uv);
            let room = point.error + 8.0 * UNIT * (2.0 + b.t.abs());
            prop_assert!((point.position - (start + d * b.t)).abs().max_element() <= room);
            let bounds = small.bounds();
            prop_assert!(bounds.min.cmple(point.position).all() && bounds.max.cmpge(point.position).all());
        }
        agree(axis, axis, 1.0, 0.3, &line(start, d))?;
    }

    #[test]
    fn tangents_are_derivatives(axis in vector(), u in 0.0..1.0f64, v in 0.0..1.0f64) {
        let torus = Torus::new(DVec3::ZERO, axis, 2.0, 0.5).unwrap();
        let (at, h) = (torus.point_at([u, v]), 1e-5);
        for (k, [a, b]) in [[[u - h, v], [u + h, v]], [[u, v - h], [u, v + h]]].into_iter().enumerate() {
            let (a, b) = (torus.point_at(a), torus.point_at(b));
            prop_assert!(((b.position - a.position) / (2.0 * h) - at.dp[k]).length() < 1e-6);
            prop_assert!(((b.normal - a.normal) / (2.0 * h) - at.dn[k]).length() < 1e-6);
        }
    }
}

#[test]
fn a_line_through_both_sides_has_four_roots_and_a_tangent_one() {
    let torus = Torus::new(DVec3::ZERO, DVec3::Z, 4.0, 1.0).unwrap();
    let along_x = |y: f64, z: f64| hits(&torus, &Ray::new(DVec3::new(-10.0, y, z), DVec3::X * 2.0));
    assert_eq!(along_x(0.0, 0.0).iter().map(|m| m.t).collect::<Vec<_>>(), [2.5, 3.5, 6.5, 7.5]);
    let outer = along_x(5.0, 0.0);
    assert_eq!(outer.iter().map(|m| (m.t, m.contact)).collect::<Vec<_>>(), [(5.0, Contact::Touching)]);
    // Along the tangent of the top circle, and through two points of the inner equator.
    assert_eq!(along_x(4.0, 1.0).iter().map(|m| m.contact).collect::<Vec<_>>(), [Contact::Touching]);
    assert_eq!(along_x(3.0, 0.0).len(), 3);
    assert_eq!(along_x(5.0 + 1e-15, 0.0).len(), 0);
    for ray in [
        Ray::new(DVec3::NAN, DVec3::X),
        Ray::new(DVec3::X, DVec3::ZERO),
        Ray::new(DVec3::X, DVec3::new(f64::INFINITY, 0.0, 0.0)),
    ] {
        assert!(hits(&torus, &ray).is_empty());
    }
}

#[test]
fn points_are_drawn_evenly() {
    for minor in [0.5, 2.0] {
        let torus = Torus::new(DVec3::ZERO, DVec3::Z, 2.0, minor).unwrap();
        let (mut counts, mut shares) = ([0; 64], [0.0; 64]);
        for i in 0..60_000 {
            let uv = torus.sample(Sampler::new(1, 2, i).two(0)).unwrap().point.uv;
            let cell = |x: f64| ((x * 8.0) as usize).min(7);
            counts[cell(uv[0]) * 8 + cell(uv[1])] += 1;
        }
        for (cell, share) in shares.iter_mut().enumerate() {
            let [low, high] = [cell % 8, cell % 8 + 1].map(|k| TAU * k as f64 / 8.0);
            *share = (high - low + minor / 2.0 * (high.sin() - low.sin())) / TAU / 8.0;
        }
        assert_frequencies(&counts, &shares);
    }
}

#[test]
fn density_by_solid_angle_is_that_of_what_is_drawn() {
    let torus = Torus::new(DVec3::ZERO, DVec3::new(1.0, 2.0, 0.5), 2.0, 0.5).unwrap();
    let place = DVec3::new(4.0, -3.0, 2.0);
    // The mean of 1 / pdf is the torus's solid angle, estimated by directions in a cone around it.
    let (axis, cosine) = (Frame::new(-place.normalize()), (1.0 - (2.5 / place.length()).powi(2)).sqrt());
    let (mut by_area, mut by_angle, count) = (0.0, 0.0, 60_000);
    for i in 0..count {
        let mut sampler = Sampler::new(9, 0, i);
        if let Some(drawn) = torus.sample_from(place, sampler.two(0)) {
            let all = torus.pdf_from(place, drawn.point.position - place);
            assert!(all >= drawn.pdf * (1.0 - 1e-6));
            by_area += 1.0 / all;
        }
        let [u, v] = sampler.two(2);
        let z = 1.0 - u * (1.0 - cosine);
        let (sin, cos) = (TAU * v).sin_cos();
        let d = axis.to_world(DVec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z);
        by_angle += if torus.pdf_from(place, d) > 0.0 { TAU * (1.0 - cosine) } else { 0.0 };
    }
    // A third of the directions hit it: their number has a standard error of 0.6 %.
    assert!((by_area / by_angle - 1.0).abs() < 0.03, "{by_area} {by_angle}");
}

#[test]
fn what_is_no_torus_is_told() {
    let refusal = |axis: DVec3, major, minor| Torus::new(DVec3::ZERO, axis, major, minor).unwrap_err();
    assert!(refusal(DVec3::ZERO, 1.0, 0.5).starts_with("axis is [0, 0, 0], expected"));
    assert!(refusal(DVec3::X, -1.0, 0.5).starts_with("major_radius is -1e0, expected"));
    assert!(refusal(DVec3::X, 1.0, f64::NAN).starts_with("minor_radius is NaN, expected"));
    assert!(refusal(DVec3::X, 1.0, 1.5).starts_with("minor_radius is 1.5, expected at most major_radius 1"));
}
