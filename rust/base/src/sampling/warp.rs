//! Maps from the unit square to directions and points, with their densities.

use crate::math::trig::{sin_cos_eighth, sin_cos_turn};
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_1_PI, FRAC_PI_4};

/// A point of the unit disk, uniform by area; nearby points of the square stay close (Shirley and Chiu, "A Low
/// Distortion Map Between Disk and Square", 1997).
#[inline]
pub fn uniform_disk(u: [f64; 2]) -> DVec2 {
    let (radius, [sin, cos]) = concentric(u);
    DVec2::new(radius * cos, radius * sin)
}

/// Radius of the concentric map, and the sine and the cosine of its angle.
#[inline(always)]
fn concentric(u: [f64; 2]) -> (f64, [f64; 2]) {
    let (a, b) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
    let wide = a.abs() > b.abs();
    let (radius, other) = if wide { (a, b) } else { (b, a) };
    // At most an eighth of a turn to either side of an axis.
    let [sin, cos] = sin_cos_eighth(if radius == 0.0 { 0.0 } else { FRAC_PI_4 * (other / radius) });
    (radius, if wide { [sin, cos] } else { [cos, sin] })
}

/// A direction about +z with density cos θ / π (Malley's method).
#[inline(always)]
pub fn cosine_hemisphere(u: [f64; 2]) -> DVec3 {
    let (radius, [sin, cos]) = concentric(u);
    // The product keeps the digits of a small height, which 1 − r² would cancel, so a direction never lies in the
    // plane.
    DVec3::new(radius * cos, radius * sin, ((1.0 - radius) * (1.0 + radius)).sqrt())
}

/// The solid angle density of [`cosine_hemisphere`], 0 below the plane.
#[inline(always)]
pub fn cosine_hemisphere_pdf(direction: DVec3) -> f64 {
    direction.z.max(0.0) * FRAC_1_PI
}

/// A direction on the whole sphere, uniform by solid angle (Archimedes' hat-box theorem).
#[inline(always)]
pub fn uniform_sphere(u: [f64; 2]) -> DVec3 {
    let z = 1.0 - 2.0 * u[0];
    let [sin, cos] = sin_cos_turn(u[1]);
    // 1 − z² = 4 u (1 − u), without cancellation at the poles.
    let radius = 2.0 * (u[0] * (1.0 - u[0])).sqrt();
    DVec3::new(radius * cos, radius * sin, z)
}

/// The solid angle density of [`uniform_sphere`].
pub const UNIFORM_SPHERE_PDF: f64 = 0.25 * FRAC_1_PI;

/// Barycentric weights of a triangle's second and third corner, uniform by area. The square is folded along a diagonal,
/// which distorts less near the corners than the map with the square root (Heitz, "A Low-Distortion Map Between
/// Triangle and Square", 2019). The density is 1 / area.
#[inline(always)]
pub fn uniform_triangle(u: [f64; 2]) -> [f64; 2] {
    let [x, y] = u;
    if y > x { [0.5 * x, y - 0.5 * x] } else { [x - 0.5 * y, 0.5 * y] }
}

#[cfg(test)]
mod tests {
    use super::super::Sampler;
    use super::super::chi_square::assert_frequencies;
    use super::*;
    use std::f64::consts::{PI, TAU};

    const DRAWS: u32 = 200_000;

    /// Count the samples in each cell.
    fn histogram(cells: usize, cell: impl Fn([f64; 2]) -> usize) -> Vec<u64> {
        let mut counts = vec![0; cells];
        for sample in 0..DRAWS {
            counts[cell(Sampler::new(20, 1, sample).two(0))] += 1;
        }
        counts
    }

    /// The cell of a direction in a grid of `rows` bands of equal height and `columns` sectors.
    fn band(d: DVec3, low: f64, rows: usize, columns: usize) -> usize {
        assert!((d.length() - 1.0).abs() < 1e-14);
        let row = (((d.z - low) / (1.0 - low) * rows as f64) as usize).min(rows - 1);
        let column = (((d.y.atan2(d.x) + PI) / TAU * columns as f64) as usize).min(columns - 1);
        row * columns + column
    }

    #[test]
    fn cosine_hemisphere_has_its_density() {
        let counts = histogram(10 * 12, |u| band(cosine_hemisphere(u), 0.0, 10, 12));
        // The integral of cos θ / π over a band from z₀ to z₁ is z₁² − z₀².
        let expected: Vec<f64> = (0..120).map(|i| f64::from(2 * (i / 12) + 1) / 100.0 / 12.0).collect();
        assert_frequencies(&counts, &expected);
    }

    #[test]
    fn cosine_hemisphere_density_integrates_to_one() {
        let bands = 1000;
        let sum: f64 = (0..bands)
            .map(|i| cosine_hemisphere_pdf(DVec3::new(0.0, 0.0, (f64::from(i) + 0.5) / f64::from(bands))))
            .sum();
        assert!((sum * TAU / f64::from(bands) - 1.0).abs() < 1e-12);
        assert_eq!(cosine_hemisphere_pdf(DVec3::NEG_Z), 0.0);
    }

    #[test]
    fn directions_stay_above_the_plane() {
        let edge = 2f64.powi(-33);
        for u in [[edge, 0.5], [1.0 - edge, 0.5], [0.5, edge], [edge, edge], [0.5, 0.5]] {
            let d = cosine_hemisphere(u);
            assert!(d.z > 0.0 && (d.length() - 1.0).abs() < 1e-15, "{d}");
        }
    }

    #[test]
    fn uniform_sphere_has_its_density() {
        let counts = histogram(10 * 12, |u| band(uniform_sphere(u), -1.0, 10, 12));
        assert_frequencies(&counts, &[UNIFORM_SPHERE_PDF * 4.0 * PI / 120.0; 120]);
    }

    #[test]
    fn uniform_disk_has_its_density() {
        let counts = histogram(10 * 12, |u| {
            let p = uniform_disk(u);
            assert!(p.length() <= 1.0);
            let ring = ((p.length_squared() * 10.0) as usize).min(9);
            ring * 12 + (((p.y.atan2(p.x) + PI) / TAU * 12.0) as usize).min(11)
        });
        assert_frequencies(&counts, &[1.0 / 120.0; 120]);
    }

    #[test]
    fn uniform_triangle_has_its_density() {
        // The unit square of weights in 15 × 15 cells: those below the diagonal have probability 2 / 225, those on it
        // half of that.
        let cell = |u: [f64; 2]| {
            let [v, w] = uniform_triangle(u);
            assert!(v >= 0.0 && w >= 0.0 && v + w <= 1.0);
            (v * 15.0) as usize * 15 + (w * 15.0) as usize
        };
        let counts = histogram(225, cell);
        let expected: Vec<f64> = (0..225)
            .map(|i| match (i / 15 + i % 15).cmp(&14) {
                std::cmp::Ordering::Less => 2.0 / 225.0,
                std::cmp::Ordering::Equal => 1.0 / 225.0,
                std::cmp::Ordering::Greater => 0.0,
            })
            .collect();
        assert_frequencies(&counts, &expected);
    }
}
