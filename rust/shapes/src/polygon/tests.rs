use super::*;
use crate::Contact;
use proptest::prelude::*;
use raywright_base::sampling::Sampler;
use raywright_base::sampling::chi_square::assert_frequencies;

/// An L with a square hole, in integers.
const L: [[i64; 2]; 6] = [[0, 0], [8, 0], [8, 4], [4, 4], [4, 8], [0, 8]];
const HOLE: [[i64; 2]; 4] = [[1, 1], [1, 3], [3, 3], [3, 1]];

fn lifted(points: &[[i64; 2]], lift: impl Fn(DVec2) -> DVec3) -> Vec<DVec3> {
    points.iter().map(|p| lift(DVec2::from_array(p.map(|x| x as f64)))).collect()
}

fn level() -> Polygon {
    let lift = |p: DVec2| p.extend(5.0);
    Polygon::new(lifted(&L, lift), vec![lifted(&HOLE, lift)]).unwrap()
}

fn hits(shape: &dyn Shape, ray: &Ray) -> Vec<Candidate> {
    let mut all = Vec::new();
    shape.meet(ray, &mut |met| {
        all.push(met);
        false
    });
    all
}

/// Return whether a point in sixteenths is inside (1), on the border (0) or outside (−1), in integers.
fn side(p: [i64; 2]) -> i32 {
    let mut inside = false;
    for ring in [&L[..], &HOLE[..]] {
        for (i, a) in ring.iter().enumerate() {
            let (a, b) = (a.map(|x| 16 * x), ring[(i + 1) % ring.len()].map(|x| 16 * x));
            let cross = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
            let within = |k: usize| a[k].min(b[k]) <= p[k] && p[k] <= a[k].max(b[k]);
            if cross == 0 && within(0) && within(1) {
                return 0;
            }
            if (a[1] > p[1]) != (b[1] > p[1]) && (cross > 0) == (b[1] > a[1]) {
                inside = !inside;
            }
        }
    }
    if inside { 1 } else { -1 }
}

/// A prism over the L with its hole, rotated and moved so that its corners are rounded. Every edge is shared by two
/// polygons.
fn prism(turn: [f64; 3], shift: DVec3) -> Vec<Polygon> {
    let lift = |z: f64| {
        move |p: DVec2| glam::DQuat::from_euler(glam::EulerRot::XYZ, turn[0], turn[1], turn[2]) * p.extend(z) + shift
    };
    let faces = |z: f64| [lifted(&L, lift(z)), lifted(&HOLE, lift(z))];
    let ([l0, h0], [l1, h1]) = (faces(0.0), faces(3.0));
    let mut all = vec![
        Polygon::new(l0.iter().rev().copied().collect(), vec![h0.clone()]).unwrap(),
        Polygon::new(l1.clone(), vec![h1.clone()]).unwrap(),
    ];
    for (low, high) in [(l0, l1), (h0, h1)] {
        for i in 0..low.len() {
            let j = (i + 1) % low.len();
            all.push(Polygon::new(vec![low[i], low[j], high[j], high[i]], vec![]).unwrap());
        }
    }
    all
}

fn direction() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from_array).prop_filter("long", |d| d.length() > 0.1)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]
    #[test]
    fn decisions_are_those_of_integers(
        target in [-2i64..=9, -2..=9], part in [0i64..16, 0..16], o in [-20i64..20, -20..20, -20..5],
        power in -90i32..90,
    ) {
        let at = [target[0] * 16 + part[0], target[1] * 16 + part[1]];
        let origin = DVec3::from_array(o.map(|x| x as f64));
        let p = DVec3::new(at[0] as f64 / 16.0, at[1] as f64 / 16.0, 5.0);
        let scale = 2f64.powi(power);
        let found = hits(&level(), &Ray::new(origin, (p - origin) * scale));
        let wanted = side(at);
        prop_assert_eq!(found.len(), usize::from(wanted >= 0));
        for met in found {
            prop_assert_eq!(met.contact == Contact::Inside, wanted == 1);
            prop_assert!((met.t * scale - 1.0).abs() < 1e-15);
            prop_assert!((met.uv[0] * 8.0 - p.x).abs() + (met.uv[1] * 8.0 - p.y).abs() < 1e-14);
        }
    }

    #[test]
    fn shared_edges_let_nothing_through(
        turn in prop::array::uniform3(-3.0..3.0f64), shift in prop::array::uniform3(-100.0..100.0f64), d in direction(),
        face in 0usize..12, edge in 0usize..8, along in prop_oneof![Just(0.0), Just(0.5), 0.0..1.0f64],
        far in prop_oneof![Just(0.0), Just(1e3), Just(1e8)],
    ) {
        let faces = prism(turn, DVec3::from_array(shift));
        let rings = &faces[face].rings;
        let ring = &rings[edge % rings.len()];
        let (a, b) = (ring[edge % ring.len()], ring[(edge + 1) % ring.len()]);
        let target = a + (b - a) * along;
        let origin = target - d * far;
        let mut ray = Ray::new(origin, target - origin);
        if far == 0.0 {
            ray = Ray::new(target, d);
        }
        ray.t_min = f64::NEG_INFINITY;
        let all = |r: &Ray| faces.iter().flat_map(|f| hits(f, r)).collect::<Vec<_>>();
        let crossed = |r: &Ray| all(r).iter().filter(|m| m.contact != Contact::Touching).count();
        prop_assert_eq!(crossed(&ray) % 2, 0);
        // The middle of the long arm of the L lies inside the prism.
        let inside = (rings_middle(&faces) + target * 1e-9) / (1.0 + 1e-9);
        prop_assert_eq!(crossed(&Ray::new(inside, target - inside)) % 2, 1);
    }

    #[test]
    fn far_origins_and_grazing_directions_keep_their_digits(
        x in 0.0..4.0f64, y in 4.0..8.0f64, d in direction(), far in 0f64..1e9,
    ) {
        let p = DVec3::new(x, y, 5.0);
        let origin = p - d * far;
        let ray = Ray { t_min: f64::NEG_INFINITY, ..Ray::new(origin, d) };
        for met in hits(&level(), &ray) {
            // The height of the plane over the slope, each exact to 32 digits.
            let t = (DoubleDouble::difference(5.0, origin.z) / DoubleDouble::from(d.z)).to_f64();
            prop_assert!((met.t - t).abs() <= f64::EPSILON * t.abs());
            let point = level().point(&ray, met.t, met.uv);
            let room = point.error + 8.0 * UNIT * (1.0 + origin.length() + 2.0 * far);
            prop_assert!((point.position - ray.at(met.t)).abs().max_element() <= room);
        }
    }
}

/// A point well inside the prism.
fn rings_middle(faces: &[Polygon]) -> DVec3 {
    let corner = |ring: &[DVec3]| ring[0] + (ring[1] - ring[0]) * (6.0 / 8.0) + (ring[5] - ring[0]) * (2.0 / 8.0);
    let mut low: Vec<DVec3> = faces[0].rings[0].clone();
    low.reverse();
    corner(&low) * 0.5 + corner(&faces[1].rings[0]) * 0.5
}

#[test]
fn edge_on_and_what_is_no_ray_hits_nothing() {
    let shape = level();
    for (o, d) in [
        (DVec3::new(-1.0, 2.0, 5.0), DVec3::X),
        (DVec3::new(-1.0, 0.0, 5.0), DVec3::X),
        (DVec3::new(-1.0, -1.0, 5.0), DVec3::new(1.0, 1.0, 0.0)),
        (DVec3::new(6.0, 2.0, 0.0), DVec3::ZERO),
        (DVec3::new(6.0, 2.0, f64::NAN), DVec3::Z),
        (DVec3::new(6.0, 2.0, 0.0), DVec3::new(0.0, f64::INFINITY, 1.0)),
    ] {
        assert!(hits(&shape, &Ray::new(o, d)).is_empty(), "{o} {d}");
    }
    let ray = |t_min, t_max| Ray { t_min, t_max, ..Ray::new(DVec3::new(6.0, 2.0, 0.0), DVec3::Z) };
    assert_eq!([(5.0, 5.0), (5.1, 9.0), (0.0, 4.9)].map(|(a, b)| hits(&shape, &ray(a, b)).len()), [1, 0, 0]);
}

#[test]
fn area_and_points_drawn_are_even() {
    let shape = level();
    assert_eq!(shape.area(), 44.0);
    let mut counts = [0; 64];
    let mut inside = [0.0; 64];
    for cell in 0..64 {
        let (x, y) = (cell as i64 % 8, cell as i64 / 8);
        inside[cell] = if side([16 * x + 8, 16 * y + 8]) > 0 { 1.0 / 44.0 } else { 0.0 };
    }
    for i in 0..50_000 {
        let drawn = shape.sample(Sampler::new(5, 0, i).two(0)).unwrap();
        assert_eq!((drawn.pdf, drawn.point.normal), (1.0 / 44.0, DVec3::Z));
        let p = drawn.point.position;
        assert_eq!(p.z, 5.0);
        counts[p.y as usize * 8 + p.x as usize] += 1;
    }
    assert_frequencies(&counts, &inside);
}

#[test]
fn what_is_no_polygon_is_told() {
    let refusal =
        |points: &[[f64; 3]]| Polygon::new(points.iter().map(|&p| DVec3::from_array(p)).collect(), vec![]).unwrap_err();
    assert_eq!(refusal(&[[0.0; 3], [1.0; 3]]), "the outline has 2 points, expected at least 3");
    assert!(refusal(&[[0.0; 3], [1.0; 3], [f64::NAN; 3]]).starts_with("point 2 of the outline is"));
    assert!(refusal(&[[0.0; 3], [1.0; 3], [2.0; 3]]).starts_with("the outline encloses no area"));
    let bent = refusal(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.1], [0.0, 1.0, 0.0]]);
    assert!(bent.contains("off the plane, expected at most"), "{bent}");
    let bow = refusal(&[[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [0.0, 1.0, 1.0], [3.0, 3.0, 1.0]]);
    assert!(bow.contains("crosses or touches"), "{bow}");
}
