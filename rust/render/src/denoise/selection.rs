//! Which way to filter is best where.

use super::super::denominators::{Denominators, cross};
use super::planes::{Size, blurred};
use raywright_base::parallel;
use raywright_optics::Rgb;

/// Errors are compared over squares that go so far, twice one after the other.
const REACH: usize = 1;

/// What was chosen passes into each other over so many pixels.
const SEAM: usize = 1;

/// A picture of the candidates, each where an independent and unbiased picture finds it the best.
///
/// The squared difference of a candidate from that picture is its squared error, and the picture's variance, which is
/// the same for all. So their differences are without bias, and many pixels together tell which candidate errs least.
/// They count by how bright the picture is, as far as the half of which the candidates were made (the first is that)
/// and the other picture, of half as many samples, tell: a lamp that only one of them has met is bright, and beside it
/// the dark counts by the dark, so that no filter is good where it spills light. `variance` is that of the half, which
/// has so many `samples`.
pub(super) fn selected(
    candidates: &[Vec<Rgb>],
    witness: &[Rgb],
    variance: &[Rgb],
    samples: f64,
    size: Size,
) -> Vec<Rgb> {
    let plain = &candidates[0];
    let count = plain.len();
    let all: Vec<Rgb> = plain.iter().zip(witness).map(|(half, quarter)| (*half * 2.0 + *quarter) / 3.0).collect();
    let weight = |i: usize| {
        let cross = cross(&all, size.width, i % size.width, i / size.width);
        Denominators::new(&cross, variance[i] * (2.0 / 3.0), samples * 1.5).inverse
    };
    let weights: Vec<Rgb> = parallel::collect(count, weight);
    let errors: Vec<Vec<f64>> = candidates
        .iter()
        .map(|candidate| {
            let of = |i: usize| {
                let (off, plain) = (candidate[i] - witness[i], plain[i] - witness[i]);
                (off * off - plain * plain).dot(weights[i])
            };
            let each: Vec<f64> = parallel::collect(count, of);
            blurred(&blurred(&each, size, REACH), size, REACH)
        })
        .collect();
    let best = |i: usize| {
        (1..errors.len()).fold(0, |best, other| if errors[other][i] < errors[best][i] { other } else { best })
    };
    let best: Vec<usize> = (0..count).map(best).collect();
    let mut picture = vec![Rgb::ZERO; count];
    for (number, candidate) in candidates.iter().enumerate() {
        let shares: Vec<f64> = best.iter().map(|&best| f64::from(u8::from(best == number))).collect();
        let shares = blurred(&shares, size, SEAM);
        picture.iter_mut().zip(candidate).zip(shares).for_each(|((sum, value), share)| *sum += *value * share);
    }
    picture
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::Sampler;

    #[test]
    fn each_candidate_is_taken_where_it_is_right() {
        let size = Size { width: 40, height: 40 };
        let off = |left: f64, right: f64| -> Vec<Rgb> {
            (0..size.pixels()).map(|i| Rgb::splat(1.0 + if i % 40 < 20 { left } else { right })).collect()
        };
        let noise = |i: usize| Rgb::splat(0.5 + Sampler::new(4, i as u32, 0).one(0));
        let witness: Vec<Rgb> = (0..size.pixels()).map(noise).collect();
        let variance = vec![Rgb::splat(0.25 / 6.0); size.pixels()];
        let candidates = [off(0.5, 0.5), off(0.0, 0.8), off(0.8, 0.0)];
        let found = selected(&candidates, &witness, &variance, 8.0, size);
        let wrong = found.iter().filter(|rgb| (**rgb - Rgb::ONE).abs().max() > 0.1).count();
        // Up to three columns beside where they change.
        assert!(wrong <= 3 * 40, "{wrong}");
    }
}
