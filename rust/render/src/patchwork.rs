//! Patches of pixels that take samples together.

use std::iter::once;
use std::ops::Range;

/// A partition of the film into patches, `patch` pixels per side, shifted for each sample.
///
/// Errors of pixels in a patch are correlated. With the same partition for every sample, patches would be visible as
/// blocks. So each sample has another shift, in the order of Bayer's matrix (1973), which spreads any few shifts far
/// apart. The correlation between two pixels then falls off with their distance, and noise is equally coarse but has no
/// edges. Patches never cross tile borders, which are cuts of every sample. Tiles are several patches wide, and cuts
/// close to borders are omitted, so that pixels there share with as many others.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patchwork {
    /// Pixels per side: a power of two.
    pub patch: u32,
}

impl Patchwork {
    /// Shift of the partition to the right and down, for a sample number.
    fn moved(self, number: u32) -> [u32; 2] {
        let (mut x, mut y) = (0, 0);
        let (mut bits, mut place) = (number, self.patch / 2);
        while place > 0 {
            let (one, other) = (bits & 1, bits >> 1 & 1);
            x |= place * one;
            y |= place * (one ^ other);
            (bits, place) = (bits >> 2, place / 2);
        }
        [x, y]
    }

    /// Intervals of a row or column of this length, with cuts at this shift.
    fn pieces(self, length: u32, moved: u32) -> impl Iterator<Item = Range<u32>> + Clone + use<> {
        let patch = self.patch;
        let is_wide = move |&cut: &u32| cut.min(length - cut) >= patch.div_ceil(2);
        let cuts = (moved..length).step_by(patch as usize).filter(move |&cut| cut > 0).filter(is_wide);
        let starts = once(0).chain(cuts.clone());
        let ends = cuts.chain(once(length));
        starts.zip(ends).map(|(start, end)| start..end)
    }

    /// Patches of a tile's pixels for a sample number, as columns and rows.
    pub fn patches(self, size: [u32; 2], number: u32) -> impl Iterator<Item = [Range<u32>; 2]> + use<> {
        let [x, y] = self.moved(number);
        let columns = self.pieces(size[0], x);
        self.pieces(size[1], y).flat_map(move |rows| columns.clone().map(move |columns| [columns, rows.clone()]))
    }

    /// Variance of a picture's total error, relative to that with a fixed partition.
    ///
    /// Two pixels at distance i along an axis share a patch in a share 1 − i/p of all samples, and the correlation of
    /// their squared errors is its square. Summed over i, that is (2p² + 1) / 3p instead of p, along each axis.
    pub fn evenness(self) -> f64 {
        let square = f64::from(self.patch).powi(2);
        ((2.0 * square + 1.0) / (3.0 * square)).powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn cuts_lie_everywhere_equally_often_and_in_quarters_first() {
        for patch in [1, 2, 4, 8] {
            let work = Patchwork { patch };
            let mut seen: Vec<_> = (0..patch * patch).map(|number| work.moved(number)).collect();
            assert_eq!(work.moved(patch * patch), seen[0]);
            if patch == 8 {
                assert_eq!(seen[..4], [[0, 0], [4, 4], [0, 4], [4, 0]]);
            }
            seen.sort_unstable();
            seen.dedup();
            assert_eq!(seen.len() as u32, patch * patch);
        }
    }

    #[test]
    fn evenness_is_what_counting_pairs_finds() {
        for patch in [1u32, 2, 4, 8] {
            // Far from borders, over all shifts: how often each pixel of a row is in the same patch as a central one.
            let work = Patchwork { patch };
            let mut with = [0.0f64; 64];
            for moved in 0..patch {
                let mine = work.pieces(64, moved).find(|piece| piece.contains(&32)).unwrap();
                mine.for_each(|i| with[i as usize] += 1.0 / f64::from(patch));
            }
            let pairs: f64 = with.iter().map(|share| share * share).sum();
            assert!(((pairs / f64::from(patch)).powi(2) / work.evenness() - 1.0).abs() < 1e-12);
        }
        assert_eq!(Patchwork { patch: 1 }.evenness(), 1.0);
    }

    proptest! {
        #[test]
        fn every_pixel_is_in_one_patch_of_fair_size(
            bits in 0u32..4, width in 1u32..40, height in 1u32..40, number in 0u32..1000,
        ) {
            let patch = 1 << bits;
            let mut met = vec![0; (width * height) as usize];
            for [columns, rows] in (Patchwork { patch }).patches([width, height], number) {
                for (side, length) in [(&columns, width), (&rows, height)] {
                    prop_assert!(2 * side.len() as u32 >= patch.min(length), "{side:?} of {length}");
                    prop_assert!(side.len() as u32 <= 2 * patch, "{side:?} of {length}");
                }
                rows.for_each(|y| columns.clone().for_each(|x| met[(y * width + x) as usize] += 1));
            }
            prop_assert!(met.iter().all(|&times| times == 1));
        }
    }
}
