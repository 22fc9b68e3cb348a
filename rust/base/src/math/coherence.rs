//! A test whether the rays of a batch are coherent.

use glam::DVec3;

/// Number of sampled pairs of neighbors.
const PAIRS: usize = 16;

/// Return whether rays, given as origins and directions, are coherent: most neighbors start within a hundredth of
/// `extent` of each other, with directions less than 8 degrees apart. A few evenly spaced pairs are sampled. The answer
/// affects speed only.
pub fn is_coherent(count: usize, ray: impl Fn(usize) -> (DVec3, DVec3), extent: f64) -> bool {
    const COSINE_SQUARED: f64 = 0.98;
    let step = (count / PAIRS).max(2);
    let (mut near, mut all) = (0, 0);
    for at in (0..count.saturating_sub(1)).step_by(step) {
        let [(from, a), (from_next, b)] = [ray(at), ray(at + 1)];
        let cosine = a.dot(b);
        let lengths = a.length_squared() * b.length_squared();
        // Extreme lengths overflow or underflow, and fail both comparisons.
        let same_way = cosine > 0.0 && cosine * cosine >= COSINE_SQUARED * lengths;
        near += usize::from(same_way && (from - from_next).length_squared() <= 1e-4 * extent * extent);
        all += 1;
    }
    4 * near >= 3 * all
}

#[cfg(test)]
mod tests {
    use super::super::Ray;
    use super::*;

    fn is_coherent(rays: &[Ray], extent: f64) -> bool {
        super::is_coherent(rays.len(), |i| (rays[i].origin, rays[i].direction), extent)
    }

    fn fan(spread: f64, shift: f64) -> Vec<Ray> {
        let at = |i: u32| f64::from(i.wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 24) - 0.5;
        (0..200u32)
            .map(|i| Ray::new(DVec3::X * shift * at(i), DVec3::new(spread * at(7 * i + 1), spread * at(3 * i), 1.0)))
            .collect()
    }

    #[test]
    fn a_camera_is_coherent_and_scattered_light_is_not() {
        assert!(is_coherent(&fan(0.05, 0.0), 1.0));
        assert!(!is_coherent(&fan(3.0, 0.0), 1.0));
        assert!(!is_coherent(&fan(0.05, 1.0), 1.0));
        assert!(is_coherent(&fan(0.05, 1.0), 1000.0));
        let back_and_forth: Vec<_> =
            (0..64).map(|i| Ray::new(DVec3::ZERO, if i % 2 == 0 { DVec3::Z } else { -DVec3::Z })).collect();
        assert!(!is_coherent(&back_and_forth, 1.0));
    }

    #[test]
    fn any_number_of_rays_has_an_answer() {
        for count in 0..50 {
            assert!(is_coherent(&vec![Ray::new(DVec3::ZERO, DVec3::Z); count], 1.0));
        }
    }
}
