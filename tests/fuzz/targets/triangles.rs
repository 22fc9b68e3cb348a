//! Triangles and rays made of bytes.

use super::numbers::{Range, double, double_point, one_of, single_point};
use arbitrary::{Result, Unstructured};
use raywright::accel::Primitives;
use raywright::math::{DVec3, Ray};

/// Triangles by their corners.
#[derive(Clone, Debug)]
pub struct Triangles(pub Vec<[DVec3; 3]>);

impl Primitives for Triangles {
    fn count(&self) -> usize {
        self.0.len()
    }

    fn corners(&self, primitive: u32) -> [DVec3; 3] {
        self.0[primitive as usize]
    }

    fn is_single(&self) -> bool {
        // As bits, so that NaN is an f32 too.
        self.0.iter().flatten().flat_map(|c| c.to_array()).all(|x| x.is_nan() || f64::from(x as f32) == x)
    }
}

/// Between 0 and `most` points, of f32 or, now and then, of f64.
pub fn points(u: &mut Unstructured, range: Range, most: usize) -> Result<Vec<DVec3>> {
    let is_single = !u.ratio(1, 3)?;
    let count = u.int_in_range(0..=most)?;
    (0..count)
        .map(|_| if is_single { Ok(single_point(u, range)?.as_dvec3()) } else { double_point(u, range) })
        .collect()
}

/// Triangles that share many of their corners, and shifted copies: enough for a tree of a few levels.
pub fn triangles(u: &mut Unstructured, range: Range) -> Result<Triangles> {
    let points = points(u, range, 12)?;
    let mut triangles = Vec::new();
    if !points.is_empty() {
        for _ in 0..u.int_in_range(0..=30)? {
            triangles.push([one_of(u, &points)?, one_of(u, &points)?, one_of(u, &points)?]);
        }
        let step = single_point(u, Range::Moderate)?.as_dvec3();
        let once = triangles.clone();
        for i in 1..=u.int_in_range(0..=3)? {
            // Rounded, so that f32 coordinates stay f32.
            let shifted = |c: DVec3| (c + step * f64::from(i)).as_vec3().as_dvec3();
            triangles.extend(once.iter().map(|t| t.map(shifted)));
        }
    }
    Ok(Triangles(triangles))
}

/// A point of a triangle: a corner, or one of an edge or of the inside, as exact as f64 allows.
pub fn target(u: &mut Unstructured, triangles: &Triangles) -> Result<DVec3> {
    let [a, b, c] = *u.choose(&triangles.0)?;
    let (v, w) = (f64::from(u.int_in_range(0..=8)?) / 8.0, f64::from(u.int_in_range(0..=8)?) / 8.0);
    Ok(a + (b - a) * v + (c - a) * w * (1.0 - v))
}

/// A ray that is free, or goes to or from a point of a triangle.
fn ray(u: &mut Unstructured, triangles: &Triangles) -> Result<Ray> {
    let has_targets = !triangles.0.is_empty();
    let is_from = has_targets && u.ratio(1, 4)?;
    let origin = if is_from { target(u, triangles)? } else { double_point(u, Range::Any)? };
    let direction = if has_targets && u.ratio(3, 4)? {
        (target(u, triangles)? - origin) * one_of(u, &[1.0, 1.0, -1.0, 0.5, 1e-30, 1e300])?
    } else {
        double_point(u, Range::Any)?
    };
    let kind: u8 = u.arbitrary()?;
    let (t_min, t_max) = match kind % 8 {
        0 => (double(u, Range::Any)?, double(u, Range::Any)?),
        1 => (f64::NEG_INFINITY, f64::INFINITY),
        2 => (0.0, 1.0),
        3 => (1.0, 1.0),
        4 => (-2.0, 0.0),
        _ => (0.0, f64::INFINITY),
    };
    Ok(Ray { t_min, t_max, ..Ray::new(origin, direction) })
}

/// Rays: first fans of sixteen from one point in much the same direction, then some of any kind.
pub fn rays(u: &mut Unstructured, triangles: &Triangles) -> Result<Vec<Ray>> {
    let mut rays = Vec::new();
    for _ in 0..u.int_in_range(0..=2)? {
        let first = ray(u, triangles)?;
        let size = first.direction.abs().max_element();
        let [across, up] = [double_point(u, Range::Moderate)?, double_point(u, Range::Moderate)?];
        let spread = size * one_of(u, &[0.0, 1e-16, 1e-8, 1e-3, 1e-2])?;
        let fan = (0..16).map(|i| {
            let aside = across * f64::from(i % 4) + up * f64::from(i / 4);
            let aside = if aside == DVec3::ZERO { aside } else { aside / aside.abs().max_element() };
            Ray { direction: first.direction + aside * spread, ..first }
        });
        rays.extend(fan);
    }
    for _ in 0..u.int_in_range(0..=12)? {
        rays.push(ray(u, triangles)?);
    }
    Ok(rays)
}
