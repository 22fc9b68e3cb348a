//! What was decided on how many samples pixels get, for as long as it holds.

use super::bytes::{Malformed, Reader, Writer, check};
use super::tile::FilmTile;
use std::ops::Range;

/// Shares of the samples between two mean numbers, cell by cell.
///
/// How many samples a cell has on the way depends on the mean number alone, so that an epoch can be left anywhere and
/// gone on with.
#[derive(Clone, Debug)]
pub(super) struct Epoch {
    /// Mean samples of a pixel when it begins.
    pub from: u32,
    /// Mean samples of a pixel when it ends.
    pub to: u32,
    /// The side of the patches of pixels that get the same number.
    pub patch: u32,
    /// What each cell of each tile has when it begins, and when it ends.
    pub shares: Vec<Vec<[u32; 2]>>,
}

impl Epoch {
    /// How many samples a cell has when all pixels have `samples` on average.
    #[inline]
    pub fn goal(&self, tile: usize, cell: usize, position: (u32, u32), samples: u32) -> u32 {
        let [start, end] = self.shares[tile][cell];
        let part = f64::from(samples - self.from) / f64::from(self.to - self.from);
        start + (f64::from(end - start) * part + dither(position, self.patch, cell % 2)) as u32
    }

    /// The shares of some tiles, as bytes.
    pub fn write(&self, tiles: Range<usize>, to: &mut Writer) {
        for number in [self.from, self.to] {
            to.word(number);
        }
        for tile in &self.shares[tiles] {
            for end in 0..2 {
                to.words(tile.iter().map(|share| share[end]));
            }
        }
    }

    /// What was written of the shares of some tiles, which have been read.
    pub fn read<'a>(
        tiles: impl Iterator<Item = &'a FilmTile>,
        patch: u32,
        from: &mut Reader,
    ) -> Result<Self, Malformed> {
        let mut this = Self { from: from.word()?, to: from.word()?, patch, shares: Vec::new() };
        check(this.from < this.to, "an epoch ends before it begins")?;
        check(this.to <= FilmTile::MOST, "an epoch has too many samples")?;
        for tile in tiles {
            let mut shares = vec![[0; 2]; tile.counts().len()];
            for end in 0..2 {
                from.words(shares.iter_mut().map(|share| &mut share[end]))?;
            }
            let holds = |(&count, &[start, end]): (&u32, &[u32; 2])| start <= count && count <= end;
            check(tile.counts().iter().zip(&*shares).all(holds), "a cell has other samples than it was given")?;
            check(shares.iter().all(|&[_, end]| end <= FilmTile::MOST), "a cell wants too many samples")?;
            this.shares.push(shares);
        }
        Ok(this)
    }
}

/// What is added to a number of samples before it is rounded down: evenly spread over neighbours, so that hardly any
/// are lost or won in sum (the R2 sequence of Roberts, 2018), and one half apart for the halves of a pixel. Neighbours
/// are patches of so many pixels a side.
pub(super) fn dither((x, y): (u32, u32), patch: u32, half: usize) -> f64 {
    let (x, y) = (x / patch, y / patch);
    (f64::from(x) * 0.754_877_666_246_692_8 + f64::from(y) * 0.569_840_290_998_053_3 + 0.5 * (1 - half) as f64).fract()
}
