//! Closed surfaces of any shape: a line crosses one an even number of times, a ray from inside never escapes, and exact
//! integers confirm the side of each point.

use super::accelerators;
use super::integers::{Exact, cross, dot, exact, is_met, minus, sign, weights};
use super::numbers::{Range, double_point, one_of};
use super::triangles::{Triangles, points, target};
use arbitrary::{Result, Unstructured};
use num_bigint::BigInt;
use raywright::accel::bvh::Options;
use raywright::accel::{Primitives, Side};
use raywright::math::robust::normalising_scale;
use raywright::math::{DVec3, Ray};
use std::collections::BTreeMap;

/// Panics if a surface leaks.
pub fn check(data: &[u8]) {
    let _ = surface(&mut Unstructured::new(data)).map(|(triangles, rays)| holds(&triangles, &rays));
}

/// A closed surface, and rays from within its bounds whose directions have a largest coordinate between 1 and 2.
///
/// Surfaces of tetrahedra are closed. Their union is, too, and stays closed without faces that occur twice. In this
/// sense every closed surface is a sum of tetrahedra that share a corner.
fn surface(u: &mut Unstructured) -> Result<(Triangles, Vec<Ray>)> {
    let points = points(u, Range::Moderate, 12)?;
    let mut faces: BTreeMap<[usize; 3], usize> = BTreeMap::new();
    if points.len() >= 4 {
        let mut point = || u.choose_index(points.len());
        let shared = point()?;
        for _ in 0..24 {
            let [a, b, c, d] = [shared, point()?, point()?, point()?];
            for mut face in [[a, b, c], [b, c, d], [c, d, a], [d, a, b]] {
                face.sort_unstable();
                *faces.entry(face).or_default() += 1;
            }
        }
    }
    let keeps_pairs = u.arbitrary()?;
    let mut triangles = Vec::new();
    for (face, count) in faces {
        let times = if keeps_pairs { count } else { count % 2 };
        for i in 0..times {
            let [a, b, c] = face.map(|i| points[i]);
            triangles.push(if (face[0] + i) % 2 == 0 { [a, b, c] } else { [b, a, c] });
        }
    }
    let triangles = Triangles(triangles);
    let region = triangles.region();
    let mut rays = Vec::new();
    for _ in 0..u.int_in_range(1..=24)? {
        let on_surface = |u: &mut Unstructured| {
            if triangles.0.is_empty() { double_point(u, Range::Moderate) } else { target(u, &triangles) }
        };
        let kind: u8 = u.arbitrary()?;
        let origin = match kind % 4 {
            0 => on_surface(u)?,
            1 => (on_surface(u)? + on_surface(u)?) / 2.0,
            2 => on_surface(u)? + double_point(u, Range::Moderate)? * one_of(u, &[1e-16, 1e-12, 1e-8, 1.0])?,
            _ => double_point(u, Range::Moderate)?,
        };
        let direction = if u.arbitrary()? { on_surface(u)? - origin } else { double_point(u, Range::Moderate)? };
        let is_within = region.is_empty() || origin.cmpge(region.min).all() && origin.cmple(region.max).all();
        let longest = direction.abs().max_element();
        if is_within && longest > 0.0 {
            let (scale, _) = normalising_scale(longest);
            rays.push(Ray::new(origin, direction * scale));
        }
    }
    Ok((triangles, rays))
}

/// Side of a point by exact integers.
enum Place {
    /// The point lies on triangles with these normals.
    On(Vec<Exact>),
    Inside,
    Outside,
}

fn place(triangles: &Triangles, point: DVec3) -> Place {
    let point = exact(point);
    let relative: Vec<[Exact; 3]> = triangles.0.iter().map(|t| t.map(|c| minus(&exact(c), &point))).collect();
    let mut normals = Vec::new();
    for [a, b, c] in &relative {
        let normal = cross(&minus(b, a), &minus(c, a));
        let has_area = normal.iter().any(|x| sign(x) != 0);
        let is_in_plane = sign(&dot(&normal, a)) == 0;
        let is_within = || [(a, b), (b, c), (c, a)].iter().all(|(v, w)| sign(&dot(&normal, &cross(v, w))) >= 0);
        if has_area && is_in_plane && is_within() {
            normals.push(normal);
        }
    }
    if !normals.is_empty() {
        return Place::On(normals);
    }
    // A direction that meets no edge, so that crossings are certain.
    for i in 1u32.. {
        let way = [i * i + 7, 3 * i + 1, i * i * i + 2].map(|x| BigInt::from(x * 7919 % 104_729));
        let mut crossed = 0;
        let is_clear = relative.iter().all(|corners| {
            let weights = weights(&way, corners);
            let met = is_met(&weights);
            let sum: BigInt = weights.iter().sum();
            let ahead: BigInt = weights.iter().zip(corners).map(|(w, p)| w * dot(&way, p)).sum();
            crossed += usize::from(met && sign(&ahead) == sign(&sum));
            !met || weights.iter().all(|w| sign(w) != 0)
        });
        if is_clear {
            return if crossed % 2 == 1 { Place::Inside } else { Place::Outside };
        }
    }
    unreachable!("there are more ways than edges")
}

fn holds(triangles: &Triangles, rays: &[Ray]) {
    let places: Vec<Place> = rays.iter().map(|ray| place(triangles, ray.origin)).collect();
    let leaving: Vec<Ray> = rays.iter().map(|ray| Ray { t_min: 0.0, ..*ray }).collect();
    let lines: Vec<Ray> = rays.iter().map(|ray| Ray { t_min: f64::NEG_INFINITY, ..*ray }).collect();
    for (name, accelerator) in accelerators::all(triangles, &Options::DEFAULT) {
        let crossings = accelerator.crossings(&lines);
        let sides = accelerator.exits(&|_| true, &leaving).sides();
        let mut occluded = vec![false; rays.len()];
        accelerator.occluded(&leaving, &mut occluded);
        for (i, ray) in rays.iter().enumerate() {
            let told = || format!("{name}, {ray:?} at {triangles:?}");
            let count = crossings.splits[i + 1] - crossings.splits[i];
            assert_eq!(count % 2, 0, "{count} crossings: {}", told());
            let direction = exact(ray.direction);
            match &places[i] {
                Place::Inside => {
                    assert_eq!(sides[i], Side::Inside, "{}", told());
                    assert!(occluded[i], "leaks: {}", told());
                }
                Place::Outside => assert_eq!(sides[i], Side::Outside, "{}", told()),
                // If all are seen edge-on, the ray cannot detect that it starts on them.
                Place::On(normals) if normals.iter().any(|n| sign(&dot(n, &direction)) != 0) => {
                    assert_eq!(sides[i], Side::Surface, "{}", told());
                }
                Place::On(_) => {}
            }
        }
    }
}
