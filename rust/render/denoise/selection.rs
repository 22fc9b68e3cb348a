//! Which way to filter is best where.

use super::super::denominators::FLOOR;
use super::planes::{Size, blurred};
use crate::optics::Rgb;
use rayon::prelude::*;

/// Errors are compared over squares that go so far, twice one after the other.
const REACH: usize = 3;

/// What was chosen passes into each other over so many pixels.
const SEAM: usize = 1;

/// A picture of the candidates, each where an independent and unbiased picture finds it the best.
///
/// The squared difference of a candidate from that picture is its squared error, and the picture's variance, which is
/// the same for all. So their differences are without bias, and many pixels together tell which candidate errs least.
/// They count by how bright `half` is around, from which the candidates were made; what shines among the dark counts by
/// the dark, so that no filter is good where it spills light.
pub(super) fn selected(half: &[Rgb], candidates: &[Vec<Rgb>], witness: &[Rgb], size: Size) -> Vec<Rgb> {
    let weights: Vec<Rgb> = (0..half.len()).into_par_iter().map(|i| weight(half, i, size)).collect();
    let plain = &candidates[0];
    let errors: Vec<Vec<f64>> = candidates
        .iter()
        .map(|candidate| {
            let of = |i: usize| {
                let (off, plain) = (candidate[i] - witness[i], plain[i] - witness[i]);
                (off * off - plain * plain).dot(weights[i])
            };
            let each: Vec<f64> = (0..half.len()).into_par_iter().map(of).collect();
            blurred(&blurred(&each, size, REACH), size, REACH)
        })
        .collect();
    let best = |i: usize| {
        (1..errors.len()).fold(0, |best, other| if errors[other][i] < errors[best][i] { other } else { best })
    };
    let best: Vec<usize> = (0..half.len()).map(best).collect();
    let mut picture = vec![Rgb::ZERO; half.len()];
    for (number, candidate) in candidates.iter().enumerate() {
        let shares: Vec<f64> = best.iter().map(|&best| f64::from(u8::from(best == number))).collect();
        let shares = blurred(&shares, size, SEAM);
        picture.iter_mut().zip(candidate).zip(shares).for_each(|((sum, value), share)| *sum += *value * share);
    }
    picture
}

/// What errors of a pixel count by: one over the square of how bright it is, the median of it and the four beside it.
fn weight(half: &[Rgb], i: usize, size: Size) -> Rgb {
    let cross = super::super::denominators::cross(half, size.width, i % size.width, i / size.width);
    let median = |channel: usize| {
        let mut five = cross.map(|rgb| rgb[channel]);
        five.sort_by(f64::total_cmp);
        five[2]
    };
    let middle = Rgb::new(median(0), median(1), median(2));
    (middle * middle + Rgb::splat(FLOOR)).recip()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Sampler;

    #[test]
    fn each_candidate_is_taken_where_it_is_right() {
        let size = Size { width: 40, height: 40 };
        let truth = vec![Rgb::ONE; size.pixels()];
        let off = |left: f64, right: f64| -> Vec<Rgb> {
            (0..size.pixels()).map(|i| Rgb::splat(1.0 + if i % 40 < 20 { left } else { right })).collect()
        };
        let noise = |i: usize| Rgb::splat(0.5 + Sampler::new(4, i as u32, 0).one(0));
        let witness: Vec<Rgb> = (0..size.pixels()).map(noise).collect();
        let found = selected(&truth, &[off(0.5, 0.5), off(0.0, 0.8), off(0.8, 0.0)], &witness, size);
        let wrong = found.iter().filter(|rgb| (**rgb - Rgb::ONE).abs().max() > 0.1).count();
        // Up to three columns beside where they change.
        assert!(wrong <= 3 * 40, "{wrong}");
    }
}
