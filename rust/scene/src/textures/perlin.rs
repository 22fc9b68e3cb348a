//! Gradient noise.

use raywright_base::math::DVec3;

/// Maximum of the sum over the eight corners' gradients, each in the worst direction. Maximizing over the cell gave
/// 1.036353811… at (0.3524, ½, ½) and its images.
const MOST: f64 = 1.036_353_9;

/// Improved noise (Perlin, "Improving Noise", 2002) with a hash instead of a table, so that it does not repeat within
/// 2³² units and every seed gives another noise. Its values are between −1 and 1 and 0 on the integer lattice. Second
/// derivatives are continuous, and features are about a unit in size.
#[inline]
pub fn perlin(p: DVec3, seed: u32) -> f64 {
    let cell = p.floor();
    let f = p - cell;
    // Wraps around far from the origin, where the spacing of floats exceeds the cells.
    let corner = cell.to_array().map(|x| x as i64 as u32);
    let fade = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    let mut sum = [0.0; 8];
    for (i, value) in sum.iter_mut().enumerate() {
        let by = [i & 1, (i >> 1) & 1, i >> 2];
        let hash = mixed([0, 1, 2].map(|k| corner[k].wrapping_add(by[k] as u32)), seed);
        *value = along(hash, f - DVec3::from_array(by.map(|b| b as f64)));
    }
    let mut step = |count: usize, t: f64| {
        for i in 0..count {
            sum[i] = sum[2 * i] + (sum[2 * i + 1] - sum[2 * i]) * t;
        }
    };
    step(4, fade.x);
    step(2, fade.y);
    step(1, fade.z);
    sum[0] / MOST
}

/// Dot product with one of the twelve directions to the edge centers of a cube.
#[inline]
fn along(hash: u32, d: DVec3) -> f64 {
    // The multiplication maps a uniform hash to 0..12 without the four duplicates of Perlin's 16 directions.
    let which = ((u64::from(hash) * 12) >> 32) as u32;
    let signed = |x: f64, bit: u32| if which & bit == 0 { x } else { -x };
    let (a, b) = match which >> 2 {
        0 => (d.x, d.y),
        1 => (d.y, d.z),
        _ => (d.z, d.x),
    };
    signed(a, 1) + signed(b, 2)
}

/// Hashes three coordinates and a seed to 32 bits: odd multipliers, then shifts and products until every input bit
/// affects every output bit.
#[inline]
fn mixed([x, y, z]: [u32; 3], seed: u32) -> u32 {
    let mut h = seed.wrapping_mul(0x9E37_79B1) ^ 0x5BD1_E995;
    for (coordinate, odd) in [(x, 0x85EB_CA77u32), (y, 0xC2B2_AE3D), (z, 0x27D4_EB2F)] {
        h = (h ^ coordinate.wrapping_mul(odd)).rotate_left(13).wrapping_mul(0x9E37_79B1);
    }
    h ^= h >> 16;
    h = h.wrapping_mul(0x7FEB_352D);
    h ^= h >> 15;
    h = h.wrapping_mul(0x846C_A68B);
    h ^ (h >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use raywright_base::sampling::chi_square::assert_frequencies;

    fn point(range: f64) -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-range..range).prop_map(DVec3::from_array)
    }

    proptest! {
        #[test]
        fn lies_between_its_bounds(p in point(1e6), seed: u32) {
            prop_assert!(perlin(p, seed).abs() <= 1.0);
        }

        #[test]
        fn is_zero_on_the_lattice(p in point(1e9), seed: u32) {
            prop_assert_eq!(perlin(p.floor(), seed), 0.0);
        }

        #[test]
        fn changes_no_faster_than_its_bound(p in point(50.0), by in point(1e-3), seed: u32) {
            // Along an axis the mean gradient contributes at most 1. The change of weights contributes at most 15/8 of
            // the difference of two values of at most 1.0364. The total is below 4.9.
            let difference = (perlin(p + by, seed) - perlin(p, seed)).abs();
            prop_assert!(difference <= 4.9 / MOST * by.abs().element_sum() + 1e-12);
        }

        #[test]
        fn is_smooth_across_cells(
            cell in point(20.0), a in 0.0..1.0f64, b in 0.0..1.0f64, axis in 0usize..3, seed: u32,
        ) {
            let mut p = cell.floor() + DVec3::new(a, b, a * b);
            p[axis] = cell.floor()[axis];
            let h = 1e-4;
            let at = |x: f64| perlin(p + DVec3::AXES[axis] * x, seed);
            prop_assert!((at(h) - at(-h)).abs() < 10.0 * h);
            // One-sided first derivatives agree to O(h).
            let (left, right) = ((at(0.0) - at(-h)) / h, (at(h) - at(0.0)) / h);
            prop_assert!((left - right).abs() < 0.01, "{} {}", left, right);
        }
    }

    #[test]
    fn its_bound_is_that_of_the_worst_gradients() {
        // The sum over corners of weight times the greatest dot product with an edge direction, over a grid of the
        // cell.
        let steps = 64;
        let mut most: f64 = 0.0;
        for i in 0..=steps * steps * steps + 3 * steps * steps {
            let n = steps + 1;
            let at = [i % n, i / n % n, (i / (n * n)).min(steps)].map(|k| f64::from(k) / f64::from(steps));
            let fade = at.map(|f| f * f * f * (f * (f * 6.0 - 15.0) + 10.0));
            let mut sum = 0.0;
            for corner in 0..8 {
                let by = [corner & 1, (corner >> 1) & 1, corner >> 2];
                let mut d = [0, 1, 2].map(|k| (at[k] - f64::from(by[k])).abs());
                d.sort_by(f64::total_cmp);
                sum +=
                    (d[1] + d[2]) * (0..3).map(|k| if by[k] == 1 { fade[k] } else { 1.0 - fade[k] }).product::<f64>();
            }
            most = most.max(sum);
        }
        assert!(most <= MOST && most > 0.999 * MOST, "{most}");
    }

    #[test]
    fn gradients_are_drawn_evenly() {
        let mut counts = [0; 12];
        for i in 0..60_000u32 {
            let hash = mixed([i % 40, i / 40 % 40, i / 1600], 7);
            counts[((u64::from(hash) * 12) >> 32) as usize] += 1;
        }
        assert_frequencies(&counts, &[1.0 / 12.0; 12]);
    }
}
