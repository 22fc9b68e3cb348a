//! Tests of the numbers of all kinds.

use super::chi_square::assert_frequencies;
use super::{BatchSize, SamplerKind};

fn kinds(samples: u32) -> [SamplerKind; 5] {
    let size = BatchSize::new(samples).unwrap();
    [
        SamplerKind::Independent,
        SamplerKind::Stratified(size),
        SamplerKind::Halton(size),
        SamplerKind::Sobol(size),
        SamplerKind::Lattice(size),
    ]
}

fn cell(u: f64, count: usize) -> usize {
    (u * count as f64) as usize
}

#[test]
fn each_number_is_uniform_over_seeds() {
    for kind in [1, 8, 64].into_iter().flat_map(kinds) {
        for (pixel, sample, dimension) in [(0, 0, 0), (17, 5, 1), (4, 63, 6), (70_000, 1000, 13), (1, 2, 600)] {
            let (mut pairs, mut ones, mut low) = (vec![0; 144], vec![0; 144], vec![0; 256]);
            for seed in 0..30_000 {
                let mut sampler = kind.sampler(seed, pixel, sample);
                let ([x, y], z) = (sampler.two(dimension), sampler.one(dimension + 1));
                pairs[cell(x, 12) * 12 + cell(y, 12)] += 1;
                ones[cell(z, 144)] += 1;
                low[(z * 2f64.powi(53)) as usize & 255] += 1;
            }
            assert_frequencies(&pairs, &[1.0 / 144.0; 144]);
            assert_frequencies(&ones, &[1.0 / 144.0; 144]);
            assert_frequencies(&low, &[1.0 / 256.0; 256]);
        }
    }
}

#[test]
fn dimensions_are_independent_over_pixels() {
    for kind in [2, 16, 64].into_iter().flat_map(kinds) {
        // Neighbors, a choice and its point, pairs that share bases, and a sum that a weak hash would reveal.
        for (first, second) in [(0, 1), (4, 5), (5, 6), (1, 9), (0, 8), (6, 1030)] {
            let (mut pairs, mut mixed, mut ones) = (vec![0; 256], vec![0; 256], vec![0; 256]);
            for pixel in 0..40_000 {
                let mut sampler = kind.sampler(5, pixel, 7 + pixel % 64);
                let ([a, b], [c, d]) = (sampler.two(first), sampler.two(second));
                pairs[cell(a, 4) << 6 | cell(b, 4) << 4 | cell(c, 4) << 2 | cell(d, 4)] += 1;
                mixed[cell(sampler.one(first), 16) << 4 | cell(c, 4) << 2 | cell(d, 4)] += 1;
                ones[cell(sampler.one(first), 16) << 4 | cell(sampler.one(second), 16)] += 1;
            }
            for counts in [pairs, mixed, ones] {
                assert_frequencies(&counts, &[1.0 / 256.0; 256]);
            }
        }
    }
}

#[test]
fn batches_are_independent_of_each_other() {
    for kind in [4, 32].into_iter().flat_map(kinds) {
        let batch = kind.batch().max(4);
        let mut counts = vec![0; 256];
        for pixel in 0..60_000 {
            let [[a, b], [c, d]] = [1, batch + 1].map(|sample| kind.sampler(2, pixel, sample).two(6));
            counts[cell(a, 4) << 6 | cell(b, 4) << 4 | cell(c, 4) << 2 | cell(d, 4)] += 1;
        }
        assert_frequencies(&counts, &[1.0 / 256.0; 256]);
    }
}

#[test]
fn samples_of_a_batch_are_paired_at_random_across_dimensions() {
    // Two samples of a batch repel each other in either dimension, but their distances in two dimensions are
    // independent. Halton points are excepted, as one point set of many dimensions.
    for kind in kinds(16).into_iter().filter(|k| !matches!(k, SamplerKind::Halton(_))) {
        let distance = |a: f64, b: f64| ((a - b).abs() * 256.0) as usize / 64;
        let (mut joint, mut sums) = (vec![0u64; 16], [[0u64; 4]; 2]);
        for pixel in 0..60_000 {
            let [mut one, mut other] = [3, 9].map(|sample| kind.sampler(1, pixel, sample));
            let [near, far] = [5, 6].map(|dimension| distance(one.two(dimension)[1], other.two(dimension)[1]));
            joint[near * 4 + far] += 1;
            sums[0][near] += 1;
            sums[1][far] += 1;
        }
        // Expected from the observed margins, which take 6 of 15 degrees of freedom, so failing is rarer than 10⁻⁴.
        let share = |n: u64| n as f64 / 60_000.0;
        let expected: Vec<f64> = (0..16).map(|i| share(sums[0][i / 4]) * share(sums[1][i % 4])).collect();
        assert_frequencies(&joint, &expected);
    }
}

#[test]
fn a_number_depends_on_its_name_only() {
    for kind in kinds(32) {
        let mut used = kind.sampler(7, 3, 37);
        for dimension in (0..40).rev() {
            let mut fresh = kind.sampler(7, 3, 37);
            assert_eq!(used.two(dimension), fresh.two(dimension));
            assert_eq!(used.one(dimension), fresh.one(dimension));
        }
        let value = |seed, pixel, sample, dimension| kind.sampler(seed, pixel, sample).one(dimension);
        let mut all = vec![value(0, 0, 0, 0)];
        for bit in 0..32 {
            all.extend([value(1 << bit, 0, 0, 0), value(1 << (bit + 32), 0, 0, 0), value(0, 1 << bit, 0, 0)]);
            all.extend([value(0, 0, 1 << bit, 0), value(0, 0, 0, 1 << bit)]);
        }
        let count = all.len();
        all.sort_by(f64::total_cmp);
        all.dedup();
        assert_eq!(all.len(), count, "{kind:?}");
    }
}

/// Mean over seeds, and variance of the mean of one batch.
fn batch_moments(kind: SamplerKind, samples: u32, of: impl Fn([f64; 2]) -> f64) -> (f64, f64) {
    const BATCHES: u32 = 8000;
    let mean = |pixel| (0..samples).map(|i| of(kind.sampler(3, pixel, i).two(1))).sum::<f64>() / f64::from(samples);
    let means: Vec<f64> = (0..BATCHES).map(mean).collect();
    let all = means.iter().sum::<f64>() / f64::from(BATCHES);
    (all, means.iter().map(|m| (m - all).powi(2)).sum::<f64>() / f64::from(BATCHES - 1))
}

#[test]
fn errors_fall_as_theory_has_it() {
    // A smooth integrand, and the inside of a circle, with means and variances of one sample in closed form.
    let smooth = |[x, y]: [f64; 2]| (x + y).exp();
    let edge = |[x, y]: [f64; 2]| f64::from(u8::from(x * x + y * y < 0.64));
    let (e, quarter) = (std::f64::consts::E, std::f64::consts::PI * 0.16);
    let smooth_moments = ((e - 1.0).powi(2), ((e * e - 1.0) / 2.0).powi(2) - (e - 1.0).powi(4));
    let edge_moments = (quarter, quarter * (1.0 - quarter));
    for (samples, kinds) in [(16u32, kinds(16)), (64, kinds(64))] {
        for kind in kinds {
            let n = f64::from(samples);
            // The exponents of Owen's nets: n⁻³ for smooth integrands, n⁻³ᐟ² for an edge. A jittered grid has n⁻² and
            // n⁻³ᐟ² (Mitchell, "Consequences of Stratified Sampling in Graphics", 1996), and a lattice has n⁻² for a
            // nonperiodic integrand. Factors of 8 allow for logarithms and constants.
            let (smooth_rate, edge_rate) = match kind {
                SamplerKind::Independent => (1.0, 1.0),
                SamplerKind::Sobol(_) => (3.0, 1.5),
                SamplerKind::Stratified(_) | SamplerKind::Lattice(_) | SamplerKind::Halton(_) => (2.0, 1.5),
            };
            for (of, (mean, variance), rate) in
                [(&smooth as &dyn Fn([f64; 2]) -> f64, smooth_moments, smooth_rate), (&edge, edge_moments, edge_rate)]
            {
                let (found, spread) = batch_moments(kind, samples, of);
                // Five standard errors are exceeded once in two million.
                let error = (spread / 8000.0).sqrt();
                assert!((found - mean).abs() < 5.0 * error, "{kind:?}: {found} ± {error}, not {mean}");
                let gain = variance / spread;
                if rate == 1.0 {
                    assert!((gain / n - 1.0).abs() < 0.1, "{kind:?}: {gain}");
                } else {
                    assert!(gain > n.powf(rate) / 8.0, "{kind:?} of {samples}: {gain}");
                }
            }
        }
    }
}
