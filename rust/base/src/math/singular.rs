//! The singular values of a linear map.

use super::DVec3;
use super::robust::UNIT;

/// One-sided Jacobi rotations of a matrix' columns until they are orthogonal (Hestenes, "Inversion of Matrices by
/// Biorthogonalization and Related Results", 1958). Their lengths are the singular values, and they are the semi-axes
/// of the unit sphere's image. Small singular values are as accurate as large ones.
pub fn at_right_angles(mut columns: [DVec3; 3]) -> [DVec3; 3] {
    for _ in 0..40 {
        let mut turned = false;
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let (a, b) = (columns[i], columns[j]);
            let (aa, bb, ab) = (a.length_squared(), b.length_squared(), a.dot(b));
            if ab.abs() <= UNIT * (aa * bb).sqrt() {
                continue;
            }
            turned = true;
            let slope = (bb - aa) / (2.0 * ab);
            let tangent = 1f64.copysign(slope) / (slope.abs() + slope.hypot(1.0));
            let cosine = 1.0 / tangent.hypot(1.0);
            let sine = cosine * tangent;
            (columns[i], columns[j]) = (a * cosine - b * sine, a * sine + b * cosine);
        }
        if !turned {
            break;
        }
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axes_of_a_scaled_and_turned_sphere_are_found() {
        let (c, s) = (0.6, 0.8);
        // Scaled by 1, 1e-5 and 4 along x, y, z after a rotation about z, so that the columns are not orthogonal.
        let axes =
            at_right_angles([DVec3::new(c, 1e-5 * s, 0.0), DVec3::new(-s, 1e-5 * c, 0.0), DVec3::new(0.0, 0.0, 4.0)]);
        let mut lengths = axes.map(DVec3::length);
        lengths.sort_unstable_by(f64::total_cmp);
        for (x, y) in lengths.iter().zip([1e-5, 1.0, 4.0]) {
            assert!((x / y - 1.0).abs() < 1e-14, "{x} {y}");
        }
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            assert!(axes[i].normalize().dot(axes[j].normalize()).abs() < 1e-14);
        }
    }
}
