//! The point of a shape that is nearest to another point: what shapes share of finding it.

use raywright_base::math::{Affine, DVec3, at_right_angles};

/// Where a shape is nearest to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// The point of the shape.
    pub position: DVec3,
    /// Its coordinates on the shape.
    pub uv: [f64; 2],
}

/// The point of a segment that is nearest to another, in a plane.
pub(super) fn of_segment(a: [f64; 2], b: [f64; 2], p: [f64; 2]) -> [f64; 2] {
    let (x, y) = (b[0] - a[0], b[1] - a[1]);
    let size = x.abs().max(y.abs());
    if size == 0.0 {
        return a;
    }
    // In units of the segment, lest squares vanish.
    let (x, y) = (x / size, y / size);
    let along = ((p[0] - a[0]) * x + (p[1] - a[1]) * y) / (x * x + y * y) / size;
    if along <= 0.0 {
        a
    } else if along >= 1.0 {
        b
    } else if along <= 0.5 {
        // From the nearer end, so that its digits are kept.
        [a[0] + x * size * along, a[1] + y * size * along]
    } else {
        [b[0] + x * size * (along - 1.0), b[1] + y * size * (along - 1.0)]
    }
}

/// The place on the unit sphere that the nearest point of an ellipsoid about the origin comes from, when the sphere is
/// scaled by the semi-axes; of several, one (Eberly, "Distance from a Point to an Ellipse, an Ellipsoid, or a
/// Hyperellipsoid", 2013).
///
/// With the least semi-axis m, r = e² / m² of an axis e and z = p / e of the point, the nearest point has
/// r z / (σ + r − 1) of each semi-axis, for the only σ > 0 with which those are a unit vector. Their length falls with
/// σ, so that halving finds it to the last digit; σ is kept and not σ − 1, of which the least axis would lose digits.
pub(super) fn of_ellipsoid(semi_axes: DVec3, p: DVec3) -> DVec3 {
    let least = semi_axes.min_element();
    let z = p / semi_axes;
    let ratio = semi_axes / least;
    let r = ratio * ratio;
    let beyond = (ratio - 1.0) * (ratio + 1.0);
    let unit = |sigma: f64| DVec3::from_array([0, 1, 2].map(|i| share(r[i] * z[i], sigma + beyond[i])));
    // What the point has along the shortest axes alone.
    let short = DVec3::from_array([0, 1, 2].map(|i| if beyond[i] == 0.0 { z[i] } else { 0.0 })).length();
    if short == 0.0 {
        let flat = unit(0.0);
        let square = flat.length_squared();
        if square <= 1.0 {
            // As near on either side of the plane of the longer axes.
            let axis = (0..3).find(|&i| beyond[i] == 0.0).unwrap_or(0);
            return flat + DVec3::AXES[axis] * (1.0 - square).max(0.0).sqrt();
        }
    }
    let (mut low, mut high) = (short, (r * z).length());
    // Halving by the exponent first is not needed: 1100 halvings exhaust all f64, and mostly 60 do.
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

/// The same of the image of an ellipsoid, which is an ellipsoid about other axes: the nearest point, and the place on
/// the unit sphere that it comes from.
pub(super) fn of_ellipsoid_under(
    [to_world, to_object]: [&Affine; 2],
    [center, axes]: [DVec3; 2],
    place: DVec3,
) -> (DVec3, DVec3) {
    let columns = [0, 1, 2].map(|i| to_world.vector(DVec3::AXES[i] * axes[i]));
    // In units of the largest, lest squares vanish.
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

/// A quotient; 0 of nothing.
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
        // As near to both poles of the shortest axis.
        assert_eq!(of_ellipsoid(axes, DVec3::ZERO), DVec3::Z);
    }
}
