use super::*;
use crate::Contact;
use proptest::prelude::*;
use raywright_base::math::DoubleDouble;
use raywright_base::sampling::Sampler;
use raywright_base::sampling::chi_square::assert_frequencies;
use std::f64::consts::PI;

const SPHERE: &str = "x*x + y*y + z*z - 1";

fn within(text: &str, half: f64) -> Implicit {
    Implicit::new(text, DVec3::splat(-half), DVec3::splat(half)).unwrap()
}

fn hits(shape: &Implicit, ray: &Ray) -> Vec<Candidate> {
    let mut all = Vec::new();
    shape.meet(ray, &mut |met| {
        all.push(met);
        false
    });
    all
}

/// The roots along x through the center of a box of the given half-width, as x and contact.
fn along_x(text: &str, half: f64) -> Vec<(f64, Contact)> {
    let ray = Ray::new(DVec3::new(-2.0 * half, 0.0, 0.0), DVec3::X);
    hits(&within(text, half), &ray).iter().map(|m| (m.t - 2.0 * half, m.contact)).collect()
}

fn vector() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from_array).prop_filter("long", |d| d.length() > 0.1)
}

/// The intersections of a line with the unit sphere, to 32 digits; None if too close to a tangent for f64.
fn sphere(o: DVec3, d: DVec3) -> Option<Vec<f64>> {
    let dot = |a: DVec3, b: DVec3| (0..3).fold(DoubleDouble::ZERO, |sum, i| sum + DoubleDouble::product(a[i], b[i]));
    let (a, b, c) = (dot(d, d), dot(o, d), dot(o, o) - DoubleDouble::from(1.0));
    let discriminant = b * b - a * c;
    let doubt = 1e-13 * a.high * if o.length() > 1e3 { 1e-30 * o.length_squared() + 1.0 } else { 1.0 };
    if discriminant.high.abs() < doubt {
        return None;
    }
    let root = discriminant.sqrt();
    Some(if discriminant.high < 0.0 { vec![] } else { vec![((-b - root) / a).to_f64(), ((root - b) / a).to_f64()] })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]
    #[test]
    fn no_root_of_a_product_is_skipped(
        roots in prop::collection::vec((-30i32..30, 1usize..4), 1..6), shift in -0.9..0.9f64,
    ) {
        let mut roots = roots;
        roots.sort_unstable();
        roots.dedup_by_key(|r| r.0);
        // Roots that f64 represents exactly, and others.
        for scale in [0.03125, 0.03] {
            let factor = |(r, power): &(_, _)| format!("(x - {:?})**{power}", f64::from(*r) * scale);
            let factors: Vec<String> = roots.iter().map(factor).collect();
            let text = format!("({}) * (y + {shift:?} + 2)", factors.join(" * "));
            let found = along_x(&text, 1.0);
            prop_assert_eq!(found.len(), roots.len(), "{} {:?}", text, found);
            for ((x, contact), (r, power)) in found.iter().zip(&roots) {
                prop_assert!((x - f64::from(*r) * scale).abs() < 1e-14, "{} {:?}", text, found);
                prop_assert_eq!(*contact == Contact::Touching, power % 2 == 0, "{} {:?}", text, found);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]
    #[test]
    fn a_sphere_is_met_where_it_is(
        from in vector(), target in vector(), far in prop_oneof![Just(2.0), Just(1e4), Just(1e8)],
        half in prop_oneof![Just(1.0), Just(1.5)], length in -90i32..90,
    ) {
        let origin = from * far;
        let (d, length) = (target - origin, 2f64.powi(length));
        let ray = Ray { t_min: f64::NEG_INFINITY, ..Ray::new(origin, d * length) };
        let Some(wanted) = sphere(origin, d) else { return Ok(()) };
        let found = hits(&within(SPHERE, half), &ray);
        prop_assert_eq!(found.len(), wanted.len());
        for (met, t) in found.iter().zip(wanted) {
            // An ulp of t, plus a few ulps of the coordinates along the line, scaled by the inverse cosine for grazing
            // rays.
            let grazing = ray.at(t / length).normalize().dot(d.normalize()).abs().max(1e-7);
            let room = 2.0 * f64::EPSILON * t.abs() + 16.0 * f64::EPSILON / grazing / d.length();
            prop_assert!((met.t * length - t).abs() <= room, "{} {}", met.t * length, t);
            prop_assert_eq!(met.contact, Contact::Inside);
        }
    }

    #[test]
    fn a_torus_is_met_as_often_as_the_torus(origin in vector(), target in vector()) {
        use crate::torus::Torus;
        let (origin, d) = (origin * 4.0, target - origin * 4.0);
        let ray = Ray { t_min: f64::NEG_INFINITY, ..Ray::new(origin, d) };
        let torus = |minor: f64| {
            let mut all = Vec::new();
            Torus::new(DVec3::ZERO, DVec3::Z, 1.0, minor).unwrap().meet(&ray, &mut |m| { all.push(m.t); false });
            all
        };
        let wanted = torus(0.25);
        prop_assume!([torus(0.25 + 1e-9), torus(0.25 - 1e-9)].iter().all(|t| t.len() == wanted.len()));
        let found = hits(&within("(x*x + y*y + z*z + 1 - 0.0625)**2 - 4*(x*x + y*y)", 1.25), &ray);
        prop_assert_eq!(found.len(), wanted.len());
        for (met, t) in found.iter().zip(wanted) {
            prop_assert!((met.t - t).abs() < 1e-11);
        }
    }

    #[test]
    fn a_window_shows_what_is_in_it(origin in vector(), d in vector(), a in -3.0..3.0f64, b in -3.0..3.0f64) {
        let gyroid = within("sin(3*x)*cos(3*y) + sin(3*y)*cos(3*z) + sin(3*z)*cos(3*x)", 2.0);
        let whole = Ray { t_min: f64::NEG_INFINITY, ..Ray::new(origin, d) };
        let all: Vec<f64> = hits(&gyroid, &whole).iter().map(|m| m.t).collect();
        let part = hits(&gyroid, &Ray { t_min: a.min(b), t_max: a.max(b), ..whole });
        let wanted: Vec<f64> = all.iter().copied().filter(|t| a.min(b) <= *t && *t <= a.max(b)).collect();
        prop_assert_eq!(part.iter().map(|m| m.t).collect::<Vec<_>>(), wanted);
        // Sampled sign changes are a lower bound on the number of crossings.
        let steps: Vec<f64> = (0..4000).map(|i| -8.0 + f64::from(i) * 0.004).collect();
        let inside = |t: f64| whole.at(t).abs().max_element() <= 2.0;
        let signs: Vec<bool> = steps.iter().filter(|t| inside(**t)).map(|t| gyroid.value(whole.at(*t)) > 0.0).collect();
        let crossings = signs.windows(2).filter(|w| w[0] != w[1]).count();
        prop_assert!(all.len() >= crossings);
    }

    #[test]
    fn points_lie_on_the_surface_and_tangents_along_it(origin in vector(), target in vector()) {
        let shape = within(SPHERE, 1.5);
        let origin = origin * 1e6;
        let ray = Ray::new(origin, target - origin);
        for met in hits(&shape, &ray) {
            let point = shape.point(&ray, met.t, met.uv);
            prop_assert!((point.position.length() - 1.0).abs() <= 3.0 * point.error && point.error < 1e-14);
            prop_assert!((point.normal - point.position).length() < 1e-14);
            prop_assert!((point.uv[0] - met.uv[0]).abs() + (point.uv[1] - met.uv[1]).abs() < 1e-7);
            for k in 0..2 {
                // On the unit sphere the normal equals the position.
                prop_assert!(point.dp[k].dot(point.normal).abs() < 1e-13);
                prop_assert!((point.dn[k] - point.dp[k]).length() < 1e-12);
            }
        }
    }
}

#[test]
fn roots_that_touch_or_cross_flatly_are_told_once() {
    use Contact::{Inside, Touching};
    assert_eq!(along_x("x**2", 1.0), [(0.0, Touching)]);
    assert_eq!(along_x("(x - 0.5)**3", 1.0), [(0.5, Inside)]);
    let double = along_x("(x*x + y*y + z*z - 1)**2", 1.5);
    assert_eq!(double.iter().map(|r| r.1).collect::<Vec<_>>(), [Touching, Touching]);
    assert!((double[0].0 + 1.0).abs() < 1e-15 && (double[1].0 - 1.0).abs() < 1e-15);
    let near = along_x("(x - 0.5)*(x - 0.5 - 1e-9)", 1.0);
    assert_eq!(near.iter().map(|r| r.1).collect::<Vec<_>>(), [Inside, Inside]);
    assert!((near[1].0 - near[0].0 - 1e-9).abs() < 1e-15);
}

#[test]
fn stretches_are_told_once_where_they_begin() {
    assert_eq!(along_x("max(abs(x) - 1, 0)", 3.0).len(), 1);
    assert!((along_x("max(abs(x) - 1, 0)", 3.0)[0].0 + 1.0).abs() < 1e-14);
    assert!((along_x("max(x - 0.25, 0) + min(x + 0.75, 0)", 1.0)[0].0 + 0.75).abs() < 1e-14);
    // Identically zero, which intervals cannot decide: one hit, found quickly.
    for text in ["x - y - (x - y)", "sin(x)**2 + cos(x)**2 - 1", "0*x"] {
        assert_eq!(along_x(text, 1.0).len(), 1, "{text}");
    }
}

#[test]
fn poles_jumps_and_the_ends_of_domains_are_no_roots() {
    for text in [
        "1/x",
        "x/abs(x)",
        "1/x**3",
        "atan2(0.3 + 0*x, x) - 7",
        "1/(x - 0.3)",
        "atan2(x, -0.3) + 0*x + 0.0001",
        "exp(1/x) + 1",
    ] {
        assert_eq!(along_x(text, 1.0), [], "{text}");
    }
    let places = |text: &str, half: f64| along_x(text, half).into_iter().map(|r| r.0).collect::<Vec<_>>();
    let close = |found: Vec<f64>, wanted: &[f64], text: &str| {
        assert_eq!(found.len(), wanted.len(), "{text}: {found:?}");
        assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-14), "{text}: {found:?}");
    };
    close(places("tan(x)", 4.0), &[-PI, 0.0, PI], "tan");
    close(places("1/x - 0.5", 4.0), &[2.0], "1/x - 0.5");
    close(places("sqrt(x)", 1.0), &[0.0], "sqrt");
    close(places("log(x)", 2.0), &[1.0], "log");
    close(places("sqrt(x) - 0.5", 1.0), &[0.25], "sqrt(x) - 0.5");
    close(places("x**0.5 - x", 2.0), &[0.0, 1.0], "x**0.5 - x");
    close(places("abs(x) - 0.3", 1.0), &[-0.3, 0.3], "abs(x) - 0.3");
    close(places("max(x - 0.5, -x - 0.25)", 1.0), &[-0.25, 0.5], "max");
}

#[test]
fn many_roots_are_all_found_in_order() {
    let found = along_x("sin(50*x)", 1.0);
    assert_eq!(found.len(), 31);
    for (root, k) in found.iter().zip(-15..=15) {
        assert!((root.0 - f64::from(k) * PI / 50.0).abs() < 1e-15);
    }
    // Infinitely many roots: the distinguishable ones come first, and the search ends.
    let crowded = along_x("x*sin(1/x)", 1.0);
    assert!(crowded.len() > 100 && crowded.windows(2).all(|w| w[0].0 < w[1].0));
    assert!((crowded[0].0 + 1.0 / PI).abs() < 1e-14);
}

#[test]
fn what_is_no_ray_hits_nothing_and_faces_of_the_box_count() {
    let tight = within(SPHERE, 1.0);
    let edge = hits(&tight, &Ray::new(DVec3::new(1.0, -3.0, 0.0), DVec3::Y));
    assert_eq!(edge.iter().map(|m| (m.t, m.contact)).collect::<Vec<_>>(), [(3.0, Contact::Touching)]);
    assert_eq!(hits(&tight, &Ray::new(DVec3::X, -DVec3::X)).iter().map(|m| m.t).collect::<Vec<_>>(), [0.0, 2.0]);
    for (o, d) in [(DVec3::NAN, DVec3::X), (DVec3::ZERO, DVec3::ZERO), (DVec3::ZERO, DVec3::new(1.0, f64::NAN, 0.0))] {
        assert!(hits(&tight, &Ray::new(o, d)).is_empty());
    }
    assert!(hits(&tight, &Ray::new(DVec3::splat(f64::MAX), DVec3::X)).is_empty());
}

#[test]
fn areas_are_right_to_a_thousandth() {
    for (text, half, wanted) in [
        ("z - 0.3", 1.0, 4.0),
        ("x + y + z", 1.0, 3.0 * 3f64.sqrt()),
        ("x*x + y*y - 0.25", 1.0, 2.0 * PI),
        ("(x*x + y*y + z*z + 1 - 0.0625)**2 - 4*(x*x + y*y)", 1.3, PI * PI),
    ] {
        let area = within(text, half).area();
        assert!((area / wanted - 1.0).abs() < 1e-3, "{text}: {area} of {wanted}");
    }
    // A tube of radius 1/2 and height 2 with its height doubled: normals across it are twice as long.
    let tube = within("x*x + y*y - 0.25", 1.0);
    let doubled = tube.integral(&|n| DVec3::new(2.0 * n.x, 2.0 * n.y, n.z).length());
    assert!((doubled / (4.0 * PI) - 1.0).abs() < 1e-3);
    assert_eq!(within("x*x + 1", 1.0).area(), 0.0);
    assert!(within("x*x + 1", 1.0).sample([0.5; 2]).is_none());
}

#[test]
fn points_are_drawn_evenly() {
    let shape = within("(x - 0.2)**2 + y*y + z*z - 1", 1.7);
    let mut counts = [0; 80];
    for i in 0..8000 {
        let drawn = shape.sample(Sampler::new(4, 0, i).two(0)).unwrap();
        assert_eq!(drawn.pdf, 1.0 / shape.area());
        let p = drawn.point.position - DVec3::X * 0.2;
        let (row, column) = (((p.x + 1.0) * 5.0) as usize, ((p.z.atan2(p.y) + PI) / PI * 4.0) as usize);
        counts[row.min(9) * 8 + column.min(7)] += 1;
    }
    assert_frequencies(&counts, &[1.0 / 80.0; 80]);
}

#[test]
fn what_is_no_surface_is_told() {
    let refusal = |text, min, max| Implicit::new(text, DVec3::splat(min), DVec3::splat(max)).unwrap_err();
    assert!(
        refusal("x + foo", -1.0, 1.0)
            .starts_with("expression \"x + foo\": unknown name 'foo' at column 5; known: x, y, z,")
    );
    assert!(refusal("x", 1.0, 1.0).starts_with("min is [1, 1, 1] and max is [1, 1, 1], expected"));
    assert!(refusal("x", f64::NAN, 1.0).contains("expected finite numbers"));
    assert!(refusal("x", 1e15, 1e15 + 1.0).contains("64 ulps"));
}
