//! Sample allocation of an adaptive epoch.

use super::bytes::{Malformed, Reader, Writer, check};
use super::tile::FilmTile;
use std::ops::Range;

/// Numbers of samples at the start and the end of an epoch, cell by cell.
///
/// In between, a cell's number of samples depends only on the mean number, so an epoch can be interrupted and resumed
/// anywhere.
#[derive(Clone, Debug)]
pub(super) struct Epoch {
    /// Mean samples per pixel at its start.
    pub from: u32,
    /// Mean samples per pixel at its end.
    pub to: u32,
    /// Side of the patches of pixels with equal counts.
    pub patch: u32,
    /// Samples of each cell of each tile at the start and the end.
    pub shares: Vec<Vec<[u32; 2]>>,
}

impl Epoch {
    /// Number of samples of a cell when all pixels have `samples` on average.
    #[inline]
    pub fn goal(&self, tile: usize, cell: usize, position: (u32, u32), samples: u32) -> u32 {
        let [start, end] = self.shares[tile][cell];
        let part = f64::from(samples - self.from) / f64::from(self.to - self.from);
        start + (f64::from(end - start) * part + dither(position, self.patch, cell % 2)) as u32
    }

    /// Writes the shares of some tiles as bytes.
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

    /// Reads the shares of tiles that have been read.
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
            check(tile.counts().iter().zip(&*shares).all(holds), "a cell's sample count is not the planned one")?;
            check(shares.iter().all(|&[_, end]| end <= FilmTile::MOST), "a cell requests too many samples")?;
            this.shares.push(shares);
        }
        Ok(this)
    }
}

/// Dither added to a number of samples before rounding down. It is uniform over neighbors, so that the total is hardly
/// changed (the R2 sequence of Roberts, 2018), and offset by one half between the halves of a pixel. Neighbors are
/// patches of `patch` pixels per side.
pub(super) fn dither((x, y): (u32, u32), patch: u32, half: usize) -> f64 {
    let (x, y) = (x / patch, y / patch);
    (f64::from(x) * 0.754_877_666_246_692_8 + f64::from(y) * 0.569_840_290_998_053_3 + 0.5 * (1 - half) as f64).fract()
}
