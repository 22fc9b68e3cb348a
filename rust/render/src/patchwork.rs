//! Which pixels take samples together.

use std::iter::once;
use std::ops::Range;

/// Patches that pixels work in, so many a side, cut elsewhere for each sample.
///
/// Pixels of a patch err together. Cut at the same places for every sample, patches would show as blocks in a picture;
/// so the cuts of each sample lie elsewhere, in the order of Bayer's matrix (1973), in which any few lie far from each
/// other. What two pixels share then falls off with their distance, and noise is as coarse but has no edges. Nothing
/// goes over the borders of tiles, so these are cuts of every sample; tiles are some patches wide, and cuts next to
/// borders are left out, so that the pixels there have as many to share with as others.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patchwork {
    /// Pixels a side: a power of two.
    pub patch: u32,
}

impl Patchwork {
    /// How far the cuts of a sample, by its number, are moved to the right and down.
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

    /// Pieces of a row or column of so many pixels, with cuts that are moved so far.
    fn pieces(self, length: u32, moved: u32) -> impl Iterator<Item = Range<u32>> + Clone + use<> {
        let patch = self.patch;
        let is_wide = move |&cut: &u32| cut.min(length - cut) >= patch.div_ceil(2);
        let cuts = (moved..length).step_by(patch as usize).filter(move |&cut| cut > 0).filter(is_wide);
        let starts = once(0).chain(cuts.clone());
        let ends = cuts.chain(once(length));
        starts.zip(ends).map(|(start, end)| start..end)
    }

    /// The patches of the pixels of a tile, in which they take the sample of a number: columns and rows.
    pub fn patches(self, size: [u32; 2], number: u32) -> impl Iterator<Item = [Range<u32>; 2]> + use<> {
        let [x, y] = self.moved(number);
        let columns = self.pieces(size[0], x);
        self.pieces(size[1], y).flat_map(move |rows| columns.clone().map(move |columns| [columns, rows.clone()]))
    }

    /// How much less errors of a picture vary in sum than if patches were cut at the same places for all samples.
    ///
    /// Two pixels that are i apart along an axis are in one patch for the share 1 − i/p of all samples, and their
    /// errors' squares are correlated by its square: summed over i, that is (2p² + 1) / 3p instead of p, along each
    /// axis.
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
            // Far from borders, over all cuts: how often each pixel of a row is with one in the middle.
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
