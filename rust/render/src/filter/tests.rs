//! Properties of every filter.

use super::*;
use raywright_base::sampling::chi_square::assert_frequencies;
use raywright_base::sampling::{BatchSize, Sampler, SamplerKind};

fn filters() -> Vec<std::boxed::Box<dyn Filter>> {
    let mut all: Vec<std::boxed::Box<dyn Filter>> = Vec::new();
    for radius in [0.5, 1.7] {
        all.push(std::boxed::Box::new(Box::new(radius).unwrap()));
        all.push(std::boxed::Box::new(Separable::new(Triangle::new(2.0 * radius).unwrap())));
        all.push(std::boxed::Box::new(Separable::new(Gaussian::new(3.0 * radius, radius).unwrap())));
        all.push(std::boxed::Box::new(Separable::new(BlackmanHarris::new(4.0 * radius).unwrap())));
    }
    for (radius, b, c) in [(2.0, 1.0 / 3.0, 1.0 / 3.0), (2.0, 1.0, 0.0), (3.0, 0.0, 0.5), (2.0, 0.0, 1.0)] {
        all.push(std::boxed::Box::new(Separable::new(Mitchell::new(radius, b, c).unwrap())));
    }
    for lobes in [1, 2, 3, 8] {
        all.push(std::boxed::Box::new(Separable::new(Lanczos::new(lobes).unwrap())));
    }
    all
}

/// Mean of a function over (0, 1), by midpoints.
fn mean(of: impl Fn(f64) -> f64) -> f64 {
    const STEPS: u32 = 1 << 16;
    (0..STEPS).map(|i| of((f64::from(i) + 0.5) / f64::from(STEPS))).sum::<f64>() / f64::from(STEPS)
}

#[test]
fn integrates_to_1_and_is_symmetric() {
    for filter in filters() {
        let radius = filter.radius();
        // Simpson's rule along x at y = 0, over the square root of the center's value.
        let along = |x: f64| filter.evaluate(x, 0.0) / filter.evaluate(0.0, 0.0).sqrt();
        let steps = 4 * 840;
        let step = radius / f64::from(steps);
        let inner: f64 = (1..steps).map(|i| f64::from(2 + 2 * (i % 2)) * along(f64::from(i) * step)).sum();
        let integral = 2.0 * (along(0.0) + inner + along(radius)) * step / 3.0;
        assert!((integral - 1.0).abs() < 1e-9, "{filter:?}: {integral}");
        for (x, y) in [(0.1, 0.3), (0.9, 0.2), (0.55, 0.55)].map(|(x, y)| (x * radius, y * radius)) {
            let value = filter.evaluate(x, y);
            for other in [(-x, y), (x, -y), (y, x), (-y, -x)] {
                assert_eq!(filter.evaluate(other.0, other.1), value);
            }
            assert_eq!(filter.evaluate(x, 1.0001 * radius), 0.0);
        }
    }
}

#[test]
fn draws_by_the_size_of_the_filter() {
    const SIDE: usize = 16;
    for filter in filters() {
        let radius = filter.radius();
        let mut counts = vec![0; SIDE * SIDE];
        for number in 0..200_000 {
            let ([x, y], weight) = filter.sample(Sampler::new(7, 0, number).two(0));
            assert!(x.abs() <= radius && y.abs() <= radius && weight.is_finite());
            assert!(weight * filter.evaluate(x, y) >= 0.0);
            let cell = |x: f64| (((x / radius + 1.0) * SIDE as f64 / 2.0) as usize).min(SIDE - 1);
            counts[cell(x) * SIDE + cell(y)] += 1;
        }
        // |f| over each cell along one axis, by midpoints; the sampling table differs by less than a thousandth.
        let steps = 2000;
        let share = |cell: usize| {
            let at = |i: usize| (2.0 * (cell as f64 + (i as f64 + 0.5) / steps as f64) / SIDE as f64 - 1.0) * radius;
            (0..steps).map(|i| filter.evaluate(at(i), 0.0).abs()).sum::<f64>()
        };
        let shares: Vec<f64> = (0..SIDE).map(share).collect();
        let total: f64 = shares.iter().sum();
        let expected: Vec<f64> =
            (0..SIDE * SIDE).map(|i| shares[i / SIDE] * shares[i % SIDE] / (total * total)).collect();
        assert_frequencies(&counts, &expected);
    }
}

#[test]
fn offsets_grow_with_u_and_weights_hardly_vary() {
    for filter in filters() {
        let mut last = -filter.radius();
        for i in 0..10_000 {
            let ([x, _], _) = filter.sample([(f64::from(i) + 0.5) / 1e4, 0.5]);
            assert!(x >= last, "{filter:?} at {i}");
            last = x;
        }
        // The mean squared weight is that of a constant magnitude, ∫|f| over ∫f, up to the table's error.
        let (of, squares) = (mean(|u| filter.sample([u, 0.5]).1.abs()), mean(|u| filter.sample([u, 0.5]).1.powi(2)));
        assert!(squares / (of * of) - 1.0 < 2e-3, "{filter:?}: {}", squares / (of * of) - 1.0);
    }
}

#[test]
fn a_ramp_comes_out_as_it_is() {
    // Means of weight · (a + b·x + c·y) over whole batches, within five standard errors.
    for filter in filters() {
        let kind = SamplerKind::Sobol(BatchSize::new(64).unwrap());
        let ramp = |x: f64, y: f64| 3.0 + 0.5 * x - 0.25 * y;
        let means: Vec<f64> = (0..4000)
            .map(|pixel| {
                let value = |number| {
                    let ([x, y], weight) = filter.sample(kind.sampler(1, pixel, number).two(0));
                    weight * ramp(10.5 + x, 7.5 + y)
                };
                (0..64).map(value).sum::<f64>() / 64.0
            })
            .collect();
        let mean = means.iter().sum::<f64>() / 4000.0;
        let error = (means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / 3999.0 / 4000.0).sqrt();
        let expected = ramp(10.5, 7.5);
        assert!((mean - expected).abs() < 5.0 * error + 1e-12, "{filter:?}: {mean} ± {error}, not {expected}");
        assert!(error < 0.05, "{filter:?}: {error}");
    }
}

#[test]
fn profiles_at_known_places() {
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-14, "{a}, not {b}");
    let mitchell = Mitchell::new(2.0, 1.0 / 3.0, 1.0 / 3.0).unwrap();
    // 8/9, 1/18 and −1/32 at 0, 1 and 3/2 (times the factor of 6 in the cubics).
    for (x, value) in [(0.0, 16.0 / 3.0), (1.0, 1.0 / 3.0), (1.5, -0.208_333_333_333_333_34), (2.0, 0.0)] {
        close(mitchell.evaluate(x), value);
    }
    close(Separable::new(mitchell).along(0.0), 8.0 / 9.0);
    let lanczos = Lanczos::new(3).unwrap();
    for whole in 1..=3 {
        assert_eq!(lanczos.evaluate(f64::from(whole)), 0.0);
    }
    // sinc(1/2) sinc(1/6) = 2/π · 3/π.
    close(lanczos.evaluate(0.5), 6.0 / std::f64::consts::PI.powi(2));
    close(BlackmanHarris::new(2.0).unwrap().evaluate(2.0), 0.000_06);
    close(Gaussian::new(1.5, 0.5).unwrap().evaluate(0.0), 1.0 - (-4.5f64).exp());
    assert_eq!(Gaussian::new(1.5, 0.5).unwrap().evaluate(1.5), 0.0);
    // A wide Gaussian is a parabola up to σ⁻², and a narrow one is complete.
    let middle = |radius, sigma| Separable::new(Gaussian::new(radius, sigma).unwrap()).along(0.0);
    assert!((middle(1.0, 64.0) / 0.75 - 1.0).abs() < 1.0 / 4096.0);
    for sigma in [1e-6, 1e-3, 1.0] {
        assert!((middle(64.0, sigma) * sigma * std::f64::consts::TAU.sqrt() - 1.0).abs() < 1e-12);
    }
}

#[test]
fn refuses_what_makes_no_sense() {
    for radius in [0.0, 1e-7, -1.0, f64::NAN, f64::INFINITY, 65.0] {
        assert!(Box::new(radius).is_err() && Triangle::new(radius).is_err() && BlackmanHarris::new(radius).is_err());
        assert!(Gaussian::new(radius, 1.0).is_err() && Gaussian::new(1.0, radius).is_err());
        assert!(Mitchell::new(radius, 0.3, 0.3).is_err());
    }
    assert_eq!(Mitchell::new(2.0, 2.0, 0.3).unwrap_err(), "b is 2, expected 0 to 1");
    assert!(Mitchell::new(2.0, 0.3, f64::NAN).is_err());
    assert!(Lanczos::new(0).is_err() && Lanczos::new(17).is_err());
}

#[test]
fn the_pixels_own_square_changes_no_bit() {
    for number in 0..1000 {
        let u = Sampler::new(3, 1, number).two(0);
        let ([x, y], weight) = Box::default().sample(u);
        assert_eq!(([0.5 + x, 0.5 + y], weight), (u, 1.0));
    }
}
