//! Any points and any triangles: every accelerator agrees with the nearest points triangle by triangle.

use super::accelerators;
use super::numbers::{Range, double_point};
use super::triangles::{Triangles, target, triangles};
use arbitrary::{Result, Unstructured};
use raywright::accel::bvh::Options;
use raywright::accel::{Nearest, Primitives};
use raywright::math::DVec3;
use raywright::shapes::triangle::nearest_point;

/// Panics if accelerators disagree.
pub fn check(data: &[u8]) {
    let _ = scene(&mut Unstructured::new(data)).map(|(triangles, points)| agree(&triangles, &points));
}

fn scene(u: &mut Unstructured) -> Result<(Triangles, Vec<DVec3>)> {
    let triangles = triangles(u, Range::Any)?;
    let count = u.int_in_range(1..=20)?;
    let points = (0..count)
        .map(|_| {
            let is_on = !triangles.0.is_empty() && u.ratio(1, 3)?;
            if is_on { target(u, &triangles) } else { double_point(u, Range::Any) }
        })
        .collect::<Result<_>>()?;
    Ok((triangles, points))
}

/// Distance and primitive, triangle by triangle: no tree, no search.
fn one_by_one(triangles: &Triangles, point: DVec3) -> (f64, u32) {
    let mut best = (f64::INFINITY, u32::MAX);
    if point.is_finite() {
        for p in (0..triangles.count() as u32).filter(|&p| triangles.is_finite(p)) {
            let distance = nearest_point(triangles.corners(p), point).distance;
            if distance < best.0 {
                best = (distance, p);
            }
        }
    }
    best
}

/// A nearest point as bits.
fn bits(nearest: &Nearest) -> ([u64; 6], u32) {
    let Nearest { distance, position: p, uv, primitive, .. } = nearest;
    ([*distance, p.x, p.y, p.z, uv[0], uv[1]].map(f64::to_bits), *primitive)
}

fn agree(triangles: &Triangles, points: &[DVec3]) {
    let region = triangles.region();
    // Beyond this distance all distances round to the same, and a nearer point decides which is least.
    let is_near = |p: &DVec3| (*p - region.centre).abs().max_element() * region.scale <= 2f64.powi(26);
    let wanted: Vec<_> = points.iter().map(|&point| one_by_one(triangles, point)).collect();
    let mut first: Option<Vec<Nearest>> = None;
    for (name, accelerator) in accelerators::all(triangles, &Options::DEFAULT) {
        let mut found = vec![Nearest::MISS; points.len()];
        accelerator.nearest(points, &[f64::INFINITY], &mut found);
        // Again, with the found distance as the limit.
        let distances: Vec<_> = found.iter().map(|n| n.distance).collect();
        let mut again = vec![Nearest::MISS; points.len()];
        accelerator.nearest(points, &distances, &mut again);
        let first = first.get_or_insert_with(|| found.clone());
        for (i, point) in points.iter().enumerate() {
            let told = || format!("{name}, {point:?} at {triangles:?}");
            assert_eq!(bits(&found[i]), bits(&first[i]), "{}", told());
            assert_eq!(bits(&again[i]), bits(&found[i]), "{}", told());
            if is_near(point) {
                assert_eq!((found[i].distance, found[i].primitive), wanted[i], "{}", told());
            }
        }
    }
}
