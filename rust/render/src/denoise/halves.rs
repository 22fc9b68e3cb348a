//! A picture in two halves of its samples, each in two quarters.

use super::super::Film;
use super::super::sample_buckets::{Sums, counts};
use raywright_optics::Rgb;

/// A picture in two halves of its samples, each in two quarters; all four are independent.
#[derive(Clone, Debug)]
pub struct Halves {
    /// Number of columns.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// Side of the patches of correlated pixels.
    pub patch: usize,
    /// Samples per pixel.
    pub samples: f64,
    /// Means of the quarters; the first two form one half.
    pub quarters: [Vec<Rgb>; 4],
    /// Variance of the mean of each half, for independent samples.
    pub variances: [Vec<Rgb>; 2],
}

impl Halves {
    /// Mean of a half.
    pub(super) fn mean(&self, half: usize) -> Vec<Rgb> {
        self.quarters[2 * half].iter().zip(&self.quarters[2 * half + 1]).map(|(a, b)| (*a + *b) / 2.0).collect()
    }

    /// Variance of the mean of a half, summed over channels.
    ///
    /// The variance for independent samples is known per pixel. Its reduction by stratification is estimated from the
    /// quarters, as one ratio for the whole picture.
    pub(super) fn variance(&self, half: usize) -> Vec<f64> {
        let [one, other] = [&self.quarters[2 * half], &self.quarters[2 * half + 1]];
        let (mut apart, mut alone) = (0.0, 0.0);
        for ((a, b), variance) in one.iter().zip(other).zip(&self.variances[half]) {
            let (mean, off) = ((*a + *b) / 2.0, (*a - *b) / 2.0);
            let weight = (mean * mean + variance.at_least(off * off) + Rgb::splat(0.01)).recip();
            apart += (off * off).dot(weight);
            alone += variance.dot(weight);
        }
        let ratio = if alone > 0.0 { (apart / alone).clamp(0.02, 2.0) } else { 1.0 };
        self.variances[half].iter().map(|variance| variance.sum() * ratio).collect()
    }
}

impl Film {
    /// The halves of the film's samples, if quarters are kept; `None` if a quarter has no whole batch.
    pub fn halves(&self) -> Option<Halves> {
        let (width, height) = (self.width() as usize, self.height() as usize);
        let none = || vec![Rgb::ZERO; width * height];
        let samples = f64::from(self.samples());
        let mut halves = Halves {
            width,
            height,
            patch: self.patch() as usize,
            samples,
            quarters: std::array::from_fn(|_| none()),
            variances: std::array::from_fn(|_| none()),
        };
        let (batch, cells) = (self.batch(), self.cells());
        if self.fewest() < 4 / cells as u32 * batch {
            return None;
        }
        for tile in self.tiles() {
            for (i, (x, y)) in tile.pixels().enumerate() {
                let pixel = y as usize * width + x as usize;
                for kind in 0..cells {
                    let sums = tile.quarters(i * cells + kind)?;
                    let counts = counts(tile.counts()[i * cells + kind], batch, cells == 2);
                    if cells == 2 {
                        halves.set(pixel, kind, &sums, 0, &counts);
                    } else {
                        (0..2).for_each(|half| halves.set(pixel, half, &sums, half, &counts));
                    }
                }
            }
        }
        Some(halves)
    }
}

impl Halves {
    /// Sets a half of a pixel from one of the halves of a cell.
    fn set(&mut self, pixel: usize, half: usize, sums: &Sums, from: usize, counts: &[u32; 4]) {
        let counts = [0, 1].map(|quarter| f64::from(counts[2 * from + quarter]));
        let [one, other] = [0, 1].map(|quarter| sums.sums[2 * from + quarter]);
        self.quarters[2 * half][pixel] = one / counts[0];
        self.quarters[2 * half + 1][pixel] = other / counts[1];
        let (count, sum) = (counts[0] + counts[1], one + other);
        let variance = ((sums.squares[from] - sum * sum / count) / (count - 1.0)).at_least(Rgb::ZERO);
        self.variances[half][pixel] = variance * (counts[0].recip() + counts[1].recip()) / 4.0;
    }
}
