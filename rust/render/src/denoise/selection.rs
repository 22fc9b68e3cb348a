//! Selection of the best filter per pixel.

use super::super::denominators::{Denominators, cross};
use super::planes::{Size, blurred};
use raywright_base::parallel;
use raywright_optics::Rgb;

/// Radius of the box over which errors are compared; applied twice.
const REACH: usize = 1;

/// Radius of the blend between different selections.
const SEAM: usize = 1;

/// Selects per pixel the candidate with the least error against an independent unbiased picture.
///
/// The squared difference from that picture is the candidate's squared error plus the picture's variance, which is
/// equal for all candidates. So differences between candidates are unbiased, and sums over many pixels identify the
/// best. Errors are relative to brightness, estimated from the half that the candidates were made from (the first is
/// that half) and from the other picture, which has half as many samples. A lamp that only one of them has hit counts
/// as bright, and dark pixels beside it count as dark, so that no filter is preferred where it leaks light. `variance`
/// is that of the half, which has this number of `samples`.
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
        // Up to three columns beside the transition.
        assert!(wrong <= 3 * 40, "{wrong}");
    }
}
