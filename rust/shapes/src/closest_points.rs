//! Closest points: helpers that several shapes share.

use raywright_base::math::{Affine, DVec3, at_right_angles};

/// The point of a shape closest to a query point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// Its position.
    pub position: DVec3,
    /// Its surface parameters.
    pub uv: [f64; 2],
}

/// The point of a segment closest to p, in 2D.
pub(super) fn of_segment(a: [f64; 2], b: [f64; 2], p: [f64; 2]) -> [f64; 2] {
    let (x, y) = (b[0] - a[0], b[1] - a[1]);
    let size = x.abs().max(y.abs());
    if size == 0.0 {
        return a;
    }
    // In units of the segment, to avoid underflow of squares.
    let (x, y) = (x / size, y / size);
    let along = ((p[0] - a[0]) * x + (p[1] - a[1]) * y) / (x * x + y * y) / size;
    if along <= 0.0 {
        a
    } else if along >= 1.0 {
        b
    } else if along <= 0.5 {
        // From the nearer end, to keep its digits.
        [a[0] + x * size * along, a[1] + y * size * along]
    } else {
        [b[0] + x * size * (along - 1.0), b[1] + y * size * (along - 1.0)]
    }
}

/// The point on the unit sphere that maps to the closest point of an origin-centered ellipsoid when scaled by the
/// semi-axes. If several are closest, one of them (Eberly, "Distance from a Point to an Ellipse, an Ellipsoid, or a
/// Hyperellipsoid", 2013).
///
/// Let m be the least semi-axis, r = e² / m² for a semi-axis e, and z = p / e. The closest point has the coordinates r
/// z / (σ + r − 1) in units of the semi-axes, for the only σ > 0 that makes them a unit vector. Their length decreases
/// with σ, so bisection finds σ to the last digit. The variable is σ rather than σ − 1, which would lose digits along
/// the least axis.
pub(super) fn of_ellipsoid(semi_axes: DVec3, p: DVec3) -> DVec3 {
    let least = semi_axes.min_element();
    let z = p / semi_axes;
    let ratio = semi_axes / least;
    let r = ratio * ratio;
    let beyond = (ratio - 1.0) * (ratio + 1.0);
    let unit = |sigma: f64| DVec3::from_array([0, 1, 2].map(|i| share(r[i] * z[i], sigma + beyond[i])));
    // The components along the shortest axes alone.
    let short = DVec3::from_array([0, 1, 2].map(|i| if beyond[i] == 0.0 { z[i] } else { 0.0 })).length();
    if short == 0.0 {
        let flat = unit(0.0);
        let square = flat.length_squared();
        if square <= 1.0 {
            // Both sides of the plane of the longer axes are equally close.
            let axis = (0..3).find(|&i| beyond[i] == 0.0).unwrap_or(0);
            return flat + DVec3::AXES[axis] * (1.0 - square).max(0.0).sqrt();
        }
    }
    let (mut low, mut high) = (short, (r * z).length());
    // 1100 bisections exhaust all f64, and usually 60 suffice, so bisecting the exponent first is not needed.
    for _ in 0..1100 {
        let middle = 0.5 * low + 0.5 * high;
        if middle <= low || middle >= high {
            break;
        }
        if unit(middle).length_squared() >= 1.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    unit(high).normalize()
}

/// The closest point of an ellipsoid under an affine map, which is an ellipsoid about other axes. Return that point and
/// its preimage on the unit sphere.
pub(super) fn of_ellipsoid_under(
    [to_world, to_object]: [&Affine; 2],
    [center, axes]: [DVec3; 2],
    place: DVec3,
) -> (DVec3, DVec3) {
    let columns = [0, 1, 2].map(|i| to_world.vector(DVec3::AXES[i] * axes[i]));
    // In units of the largest, to avoid underflow of squares.
    let size = columns.iter().map(|c| c.abs().max_element()).fold(0.0, f64::max);
    let columns = at_right_angles(columns.map(|column| column / size));
    let along = columns.map(DVec3::normalize);
    let lengths = DVec3::from_array(columns.map(DVec3::length)) * size;
    let center = to_world.point(center);
    let away = place - center;
    let unit = of_ellipsoid(lengths, DVec3::from_array(along.map(|axis| axis.dot(away))));
    let from_center: DVec3 = (0..3).map(|i| along[i] * (lengths[i] * unit[i])).sum();
    (center + from_center, to_object.vector(from_center) / axes)
}

/// A quotient, with 0 / x = 0 for all x.
fn share(of: f64, by: f64) -> f64 {
    if of == 0.0 { 0.0 } else { of / by }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_point_of_an_ellipsoid_has_its_normal_towards_the_place() {
        let axes = DVec3::new(3.0, 0.5, 1e-3);
        for i in 0..2000 {
            let angle = |by: f64| (f64::from(i) * by).sin() * 4.0;
            let place = DVec3::new(angle(1.1), angle(2.3), angle(3.7));
            let unit = of_ellipsoid(axes, place);
            assert!((unit.length() - 1.0).abs() < 1e-15);
            let (way, normal) = ((place - unit * axes).normalize(), (unit / axes).normalize());
            assert!(way.cross(normal).length() < 1e-9, "{place} {unit}");
        }
        // Both poles of the shortest axis are equally close.
        assert_eq!(of_ellipsoid(axes, DVec3::ZERO), DVec3::Z);
    }
}
