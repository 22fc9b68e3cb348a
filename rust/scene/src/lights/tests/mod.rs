//! Tests of all lights: irradiances against closed forms, and densities against samples.

mod blocks;
mod departures;
mod emission;
mod environments;
mod few;
mod instances;
mod irradiance;
mod many;
mod shapes;
mod spots;

use super::{Light, LightSample, LightSampleContext};
use crate::Scene;
use raywright_base::math::DVec3;
use raywright_base::sampling::Sampler;
use raywright_base::sampling::chi_square::assert_frequencies;
use raywright_optics::Rgb;
use std::f64::consts::TAU;

/// The origin on a plane that faces up.
const FLOOR: LightSampleContext = LightSampleContext { position: DVec3::ZERO, normal: DVec3::Z, waves: None };

/// A light sample of a scene.
fn draw(scene: &Scene, receiver: &LightSampleContext, number: u32) -> Option<LightSample> {
    let mut sampler = Sampler::new(1, 0, number);
    let (choice, u) = (sampler.one(0), sampler.two(1));
    scene.lights().sample(scene.geometry(), receiver, choice, u)
}

/// Mean and standard error of the unoccluded irradiance at a receiver; of the fluence for a receiver without normal.
fn irradiance_at(scene: &Scene, receiver: &LightSampleContext, draws: u32) -> (f64, f64) {
    let (mut sum, mut squares) = (0.0, 0.0);
    for number in 0..draws {
        if let Some(light) = draw(scene, receiver, number) {
            assert!((light.direction.length() - 1.0).abs() < 1e-12 && light.pdf > 0.0);
            let cosine = if receiver.is_free() { 1.0 } else { light.direction.dot(receiver.normal).max(0.0) };
            let x = light.weight[1] * cosine;
            sum += x;
            squares += x * x;
        }
    }
    let mean = sum / f64::from(draws);
    (mean, ((squares / f64::from(draws) - mean * mean).max(0.0) / f64::from(draws)).sqrt())
}

/// Asserts that a mean is within five standard errors, with a false alarm in two million, and that the standard error
/// is at most a share of the expected value. A deterministic estimate must agree up to the roundings of its sum.
fn assert_near((mean, error): (f64, f64), expected: f64, share: f64) {
    assert!((mean - expected).abs() <= 5.0 * error + 1e-10 * expected, "{mean} ± {error}, not {expected}");
    assert!(error <= share * expected, "{error} of {expected}");
}

/// Directions in a grid of equal cells: bands of equal height, and sectors.
struct Grid {
    rows: usize,
    columns: usize,
}

impl Grid {
    fn cell(&self, d: DVec3) -> usize {
        let row = (((d.z + 1.0) / 2.0 * self.rows as f64) as usize).min(self.rows - 1);
        let column = ((d.y.atan2(d.x) / TAU).rem_euclid(1.0) * self.columns as f64) as usize;
        row * self.columns + column.min(self.columns - 1)
    }

    /// The integral of a function over each cell, by midpoints of `parts` subdivisions in each dimension, in colatitude
    /// and azimuth. These coordinates smooth integrands that grow with the inverse of the sine.
    fn integrals(&self, parts: usize, of: impl Fn(DVec3) -> f64) -> Vec<f64> {
        let mut sums = vec![0.0; self.rows * self.columns];
        for row in 0..self.rows {
            let end = |row: usize| (2.0 * row as f64 / self.rows as f64 - 1.0).acos();
            let (from, step) = (end(row), (end(row + 1) - end(row)) / parts as f64);
            for i in 0..parts {
                let (sine, z) = (from + (i as f64 + 0.5) * step).sin_cos();
                let element = step.abs() * sine * TAU / (self.columns * parts) as f64;
                for j in 0..self.columns * parts {
                    let (sin, cos) = ((j as f64 + 0.5) / (self.columns * parts) as f64 * TAU).sin_cos();
                    let integral = &mut sums[row * self.columns + j / parts];
                    *integral += element * of(DVec3::new(sine * cos, sine * sin, z));
                }
            }
        }
        sums
    }
}

/// Asserts that the density of an infinite light integrates to 1, to within a share, and matches its samples.
fn assert_density(light: &dyn Light, receiver: &LightSampleContext, parts: usize, share: f64) {
    let grid = Grid { rows: 8, columns: 12 };
    let expected = grid.integrals(parts, |d| light.infinite_pdf(receiver, d));
    let sum: f64 = expected.iter().sum();
    assert!((sum - 1.0).abs() < share, "{light:?}: {sum}");
    let mut counts = vec![0; expected.len()];
    for number in 0..20_000 {
        let Some(sample) = light.sample(receiver, Sampler::new(5, 0, number).two(0)) else { continue };
        counts[grid.cell(sample.direction)] += 1;
        let pdf = light.infinite_pdf(receiver, sample.direction);
        assert!((pdf / sample.pdf - 1.0).abs() < 1e-6, "{pdf} {}", sample.pdf);
        let weight = light.infinite_radiance(sample.direction) / pdf;
        assert!((weight - sample.weight).abs().max() <= 1e-6 * weight.max(), "{weight}");
    }
    // Normalized, because the integral has its own error.
    let expected: Vec<f64> = expected.iter().map(|p| p / sum).collect();
    assert_frequencies(&counts, &expected);
}

fn white(x: f64) -> Rgb {
    Rgb::splat(x)
}
