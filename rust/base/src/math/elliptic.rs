//! Symmetric elliptic integrals, and the area of an ellipsoid.

/// The area of an ellipsoid from the pairwise products of its semi-axes, to a relative error of about 10⁻¹⁴.
///
/// It is `4π R_G(b²c², c²a², a²b²)` (Carlson, "Normal Elliptic Integrals of the First and Second Kinds", 1961).
pub fn ellipsoid_area(products: [f64; 3]) -> f64 {
    let largest = products.iter().fold(0f64, |m, p| m.max(p.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    let mut squares = products.map(|p| (p / largest).powi(2));
    squares.sort_unstable_by(f64::total_cmp);
    4.0 * std::f64::consts::PI * largest * integral_g(squares)
}

/// R_G(x, y, z) for 0 ≤ x ≤ y ≤ z: the mean over all directions of √(x d₁² + y d₂² + z d₃²).
fn integral_g([x, y, z]: [f64; 3]) -> f64 {
    if y == 0.0 {
        // The mean of |d₃|.
        return z.sqrt() / 2.0;
    }
    // With the middle argument in third place, nothing cancels (DLMF 19.21.10).
    let product = (x - y) * (z - y);
    (y * integral_f([x, z, y]) - product * integral_d([x, z, y]) / 3.0 + (x / y * z).sqrt()) / 2.0
}

/// R_F, by duplication (Carlson, "Numerical computation of real or complex elliptic integrals", 1995). At most one is
/// zero.
fn integral_f(mut v: [f64; 3]) -> f64 {
    loop {
        let mean = (v[0] + v[1] + v[2]) / 3.0;
        let [x, y, z] = v.map(|v| 1.0 - v / mean);
        if x.abs().max(y.abs()).max(z.abs()) < 1e-3 {
            let (e2, e3) = (x * y - z * z, x * y * z);
            // The truncated terms are of sixth order.
            return (1.0 - e2 / 10.0 + e3 / 14.0 + e2 * e2 / 24.0 - 3.0 * e2 * e3 / 44.0) / mean.sqrt();
        }
        v = duplicated(v).0;
    }
}

/// R_D, by duplication. The third argument is not zero, and at most one of the others is.
fn integral_d(mut v: [f64; 3]) -> f64 {
    let (mut sum, mut power) = (0.0, 1.0);
    loop {
        let mean = (v[0] + v[1] + 3.0 * v[2]) / 5.0;
        let [x, y, z] = v.map(|v| 1.0 - v / mean);
        if x.abs().max(y.abs()).max(z.abs()) < 1e-3 {
            let (xy, zz) = (x * y, z * z);
            let (e2, e3, e4, e5) = (xy - 6.0 * zz, (3.0 * xy - 8.0 * zz) * z, 3.0 * (xy - zz) * zz, xy * zz * z);
            let series =
                1.0 - 3.0 * e2 / 14.0 + e3 / 6.0 + 9.0 * e2 * e2 / 88.0 - 3.0 * e4 / 22.0 - 9.0 * e2 * e3 / 52.0
                    + 3.0 * e5 / 26.0;
            return 3.0 * sum + power * series / (mean * mean.sqrt());
        }
        let (next, lambda) = duplicated(v);
        sum += power / (v[2].sqrt() * (v[2] + lambda));
        power /= 4.0;
        v = next;
    }
}

fn duplicated(v: [f64; 3]) -> ([f64; 3], f64) {
    let [x, y, z] = v.map(f64::sqrt);
    let lambda = x * y + y * z + z * x;
    (v.map(|v| (v + lambda) / 4.0), lambda)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn spheroids_have_their_closed_forms() {
        assert!((ellipsoid_area([4.0; 3]) / (16.0 * PI) - 1.0).abs() < 1e-14);
        for (a, c) in [(1.0f64, 2.0f64), (3.0, 1.0), (1.0, 1e3), (1e-3, 5.0), (1e4, 1e-3)] {
            let wanted = if a < c {
                let e = (1.0 - (a / c) * (a / c)).sqrt();
                2.0 * PI * a * a * (1.0 + c / (a * e) * e.asin())
            } else {
                let e = (1.0 - (c / a) * (c / a)).sqrt();
                2.0 * PI * (a * a + c * c * e.atanh() / e)
            };
            let found = ellipsoid_area([a * c, a * c, a * a]);
            // asin and atanh near 1 lose digits themselves.
            assert!((found / wanted - 1.0).abs() < 1e-9, "{a} {c}: {found} {wanted}");
        }
    }

    #[test]
    fn a_flat_ellipsoid_is_two_disks() {
        assert!((ellipsoid_area([0.0, 0.0, 6.0]) / (12.0 * PI) - 1.0).abs() < 1e-14);
        assert_eq!(ellipsoid_area([0.0; 3]), 0.0);
    }
}
