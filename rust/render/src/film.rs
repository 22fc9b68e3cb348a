//! The film: sums of samples per pixel.

use super::bytes::{Malformed, Reader, Writer};
use super::tile::{CellSums, FilmTile};
use raywright_base::parallel;
use raywright_optics::Rgb;

/// The samples of a picture so far: for each pixel and channel their sum, and the sums for error estimates.
///
/// Error estimates use the spread of independent *batches* of samples. A batch is one sample if samples are
/// independent, and several if they are stratified. Moments of single samples are kept as well. They identify rare
/// events, and give the error before there are two batches.
///
/// A film may be in halves: each pixel then has two *cells*, with independent samples and possibly different counts,
/// and the pixel is the mean of the two cells' means; see `adaptive.rs` for the purpose.
///
/// Samples with the same number in a *patch*, a square of pixels, may have been taken together. A tile holds whole
/// patches, and the error estimate (`error.rs`) treats a patch as one unit.
///
/// Sums depend on the order of addition, so the order is fixed: samples are added one by one in blocks of 16, or of a
/// batch if that is larger, and blocks one by one. So the bits do not depend on passes, threads or tile sizes, nor on
/// appending films of single blocks from elsewhere.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    width: u32,
    height: u32,
    side: u32,
    batch: u32,
    halves: bool,
    clamp: Option<f64>,
    patch: u32,
    apart: bool,
    samples: u32,
    tiles: Vec<FilmTile>,
}

/// Statistics of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct PixelStatistics {
    /// Number of samples.
    pub samples: f64,
    /// Estimated variance of its mean.
    pub variance: Rgb,
    /// That variance for independent samples.
    pub alone: Rgb,
    /// Degrees of freedom of the variance: batches minus one per cell; 0 if it is that of single samples.
    pub degrees: f64,
    /// Mean without the largest sample of each cell.
    pub others: Rgb,
    /// Largest sample of each cell; zeros if there is no such cell.
    pub peaks: [Outlier; 2],
}

/// The largest sample of a cell.
///
/// A rare event is found by one sample of a batch, independent of stratification. So its variance is estimated from
/// single samples, and its accuracy does not depend on the number of batches.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Outlier {
    /// Its part of the variance of the pixel's mean, at most all.
    pub variance: Rgb,
    /// Mean of the pixel without it.
    pub without: Rgb,
    /// Its largest channel.
    pub brightness: f64,
    /// Squares of the other samples over its square.
    pub again: f64,
}

impl Film {
    /// Creates an empty film in square tiles, for batches of samples. With `clamp`, brighter samples are scaled down to
    /// it.
    pub fn new(width: u32, height: u32, side: u32, batch: u32, halves: bool, clamp: Option<f64>) -> Self {
        let mut film = Self::without_tiles(width, height, side, batch, halves, clamp);
        film.tiles = (0..film.tile_count()).map(|number| film.empty_tile(number)).collect();
        film
    }

    /// Creates a film that has a layout but no tiles.
    pub(super) fn without_tiles(
        width: u32,
        height: u32,
        side: u32,
        batch: u32,
        halves: bool,
        clamp: Option<f64>,
    ) -> Self {
        assert!(side > 0 && batch.is_power_of_two(), "tiles hold pixels, and batches fill blocks");
        Self { width, height, side, batch, halves, clamp, patch: 1, apart: false, samples: 0, tiles: Vec::new() }
    }

    /// Sets the patch size; tiles hold whole patches.
    pub fn in_patches(self, patch: u32) -> Self {
        assert!(patch > 0 && self.side.is_multiple_of(patch), "whole patches");
        Self { patch, ..self }
    }

    /// Sets whether four parts of the samples are kept apart ([`Film::halves`]); the film must be empty.
    pub fn kept_apart(self, apart: bool) -> Self {
        let tiles = if apart { self.tiles.into_iter().map(FilmTile::kept_apart).collect() } else { self.tiles };
        Self { apart, tiles, ..self }
    }

    /// Returns whether parts of its samples are kept apart.
    pub(super) fn is_apart(&self) -> bool {
        self.apart
    }

    /// Side of its patches.
    pub fn patch(&self) -> u32 {
        self.patch
    }

    /// Number of tiles.
    pub fn tile_count(&self) -> usize {
        self.width.div_ceil(self.side) as usize * self.height.div_ceil(self.side) as usize
    }

    /// An empty tile.
    pub(super) fn empty_tile(&self, number: usize) -> FilmTile {
        let columns = self.width.div_ceil(self.side) as usize;
        let corner = [number % columns, number / columns].map(|n| n as u32 * self.side);
        let size = [self.side.min(self.width - corner[0]), self.side.min(self.height - corner[1])];
        let tile = FilmTile::new(corner, size, self.batch, self.halves, self.clamp);
        if self.apart { tile.kept_apart() } else { tile }
    }

    /// Number of columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Number of rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Number of pixels.
    pub fn pixel_count(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Samples per pixel, or the mean number requested.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Samples per batch.
    pub fn batch(&self) -> u32 {
        self.batch
    }

    /// Cells per pixel: 2 if the film is in halves, else 1.
    pub fn cells(&self) -> usize {
        if self.halves { 2 } else { 1 }
    }

    /// Memory of its pixels in bytes; sums for batches, clamping and halves exist only if needed.
    #[cfg(test)]
    fn bytes(&self) -> usize {
        self.tiles.iter().map(FilmTile::bytes).sum()
    }

    /// Number of samples that were NaN, infinite or negative, and count as black.
    pub fn dropped(&self) -> u64 {
        self.tiles.iter().map(FilmTile::dropped).sum()
    }

    /// Number of clamped samples, and the share of the picture's radiance that clamping removed.
    pub fn clamped(&self) -> (u64, f64) {
        let count = self.tiles.iter().map(FilmTile::clamped).sum();
        if count == 0 {
            return (0, 0.0);
        }
        let mean = |of: fn(&CellSums) -> Rgb| {
            // Row by row, so that the sum does not depend on the tile size.
            let means = self.pixels(|cells| average(cells, |cell| of(cell) / f64::from(cell.count.max(1))));
            means.iter().map(|rgb| rgb.sum()).sum::<f64>()
        };
        let (left, taken) = (mean(|cell| cell.sum), mean(|cell| cell.taken));
        (count, taken / (left + taken))
    }

    /// The tiles, to be filled until each pixel has `samples` samples, or all have on average.
    pub fn extend_to(&mut self, samples: u32) -> &mut [FilmTile] {
        self.samples = samples;
        &mut self.tiles
    }

    /// The tiles, row by row from the top.
    pub(super) fn tiles(&self) -> &[FilmTile] {
        &self.tiles
    }

    /// The tiles, to be filled part of the way to another number of samples.
    pub(super) fn tiles_mut(&mut self) -> &mut [FilmTile] {
        &mut self.tiles
    }

    /// Takes the tiles out of the film.
    pub(super) fn take_tiles(&mut self) -> Vec<FilmTile> {
        std::mem::take(&mut self.tiles)
    }

    /// Returns tiles to a film that has none.
    pub(super) fn put_tiles(&mut self, tiles: Vec<FilmTile>) {
        debug_assert!(self.tiles.is_empty() && tiles.len() == self.tile_count(), "its own tiles");
        self.tiles = tiles;
    }

    /// Side of its tiles.
    pub(super) fn side(&self) -> u32 {
        self.side
    }

    /// Radiance that brighter samples are scaled down to.
    pub(super) fn clamp(&self) -> Option<f64> {
        self.clamp
    }

    /// Samples per block: passes that begin with a block can be computed before earlier ones are done.
    pub fn block(&self) -> u32 {
        FilmTile::BLOCK.max(self.batch)
    }

    /// Returns whether blocks can be appended; halves do not fill their blocks simultaneously.
    pub fn appends(&self) -> bool {
        !self.halves
    }

    /// Writes all its sums as bytes.
    pub(super) fn write(&self, to: &mut Writer) {
        to.word(self.samples);
        self.tiles.iter().for_each(|tile| tile.write(to));
    }

    /// Reads the sums of a film with the same layout. After an error, this film is invalid.
    pub(super) fn read(&mut self, from: &mut Reader) -> Result<(), Malformed> {
        self.samples = from.word()?;
        self.tiles.iter_mut().try_for_each(|tile| tile.read(from))
    }

    /// Starts keeping separate sums of the next `count` samples of each cell, as evidence ([`Film::evidence`]).
    pub(super) fn take_evidence(&mut self, count: u32) {
        parallel::each_mut(&mut self.tiles, &|_, tile| tile.take_evidence(count));
    }

    /// Sum and sum of squares of the evidence of one half of each pixel.
    pub(super) fn evidence(&self, half: usize) -> Vec<(Rgb, Rgb)> {
        self.pixels(|cells| cells[half].evidence)
    }

    /// Appends the samples that follow those here.
    ///
    /// # Panics
    /// If the films differ in layout, or are in halves, or the last block here is not full.
    #[cfg(test)]
    fn append(&mut self, next: &Self) {
        let shape = |f: &Self| (f.width, f.height, f.side, f.batch, f.halves, f.patch);
        assert_eq!(shape(self), shape(next), "films of one shape");
        assert!(self.appends() && self.samples.is_multiple_of(self.block()), "whole blocks");
        self.samples += next.samples;
        for (tile, next) in self.tiles.iter_mut().zip(&next.tiles) {
            tile.append(next);
        }
    }

    /// Maps a function of its cells over all pixels, row by row from the top.
    fn pixels<T: Clone + Default + Send>(&self, of: impl Fn(&[CellSums]) -> T + Sync) -> Vec<T> {
        let mut all = vec![T::default(); self.pixel_count()];
        // With width 0 there are no rows, and chunks must not be empty.
        let width = self.width.max(1) as usize;
        parallel::each_chunk_mut(&mut all, width, &|first, row| self.row((first / width) as u32, row, &of));
        all
    }

    /// Maps a function of its cells over the pixels of a row.
    fn row<T>(&self, y: u32, row: &mut [T], of: impl Fn(&[CellSums]) -> T) {
        let columns = self.width.div_ceil(self.side) as usize;
        let band = &self.tiles[(y / self.side) as usize * columns..][..columns];
        for (tile, part) in band.iter().zip(row.chunks_mut(self.side as usize)) {
            let first = (y % self.side) as usize * part.len();
            for (i, entry) in part.iter_mut().enumerate() {
                *entry = match self.cells() {
                    1 => of(&[tile.cell(first + i)]),
                    _ => of(&[tile.cell((first + i) * 2), tile.cell((first + i) * 2 + 1)]),
                };
            }
        }
    }

    /// Mean of each pixel; black without samples.
    pub fn means(&self) -> Vec<Rgb> {
        self.pixels(|cells| average(cells, |cell| cell.sum / f64::from(cell.count.max(1))))
    }

    /// Number of samples of each pixel.
    pub fn counts(&self) -> Vec<u32> {
        self.pixels(|cells| cells.iter().map(|cell| cell.count).sum())
    }

    /// Minimum number of samples of a cell.
    pub(super) fn fewest(&self) -> u32 {
        self.tiles.iter().map(FilmTile::fewest).min().unwrap_or(0)
    }

    /// Estimated variance of each pixel's mean. It is unbiased from two batches on. Before that, it is the variance for
    /// independent samples, which is at most too large. `None` if a cell has fewer than two samples.
    pub fn variances(&self) -> Option<Vec<Rgb>> {
        Some(self.all_spreads()?.iter().map(|spread| spread.variance).collect())
    }

    /// Statistics of each pixel; `None` if a cell has fewer than two samples.
    pub(super) fn all_spreads(&self) -> Option<Vec<PixelStatistics>> {
        (self.fewest() >= 2).then(|| self.pixels(|cells| self.spread(cells)))
    }

    /// Statistics of the pixels of a row; each cell has at least two samples.
    pub(super) fn spreads(&self, y: u32, row: &mut [PixelStatistics]) {
        self.row(y, row, |cells| self.spread(cells));
    }

    fn spread(&self, cells: &[CellSums]) -> PixelStatistics {
        let mut spread = PixelStatistics::default();
        let mean = average(cells, |cell| cell.sum / f64::from(cell.count.max(1)));
        // The variance of the mean of halves is a quarter of the sum of theirs.
        let cells_squared = cells.len().pow(2) as f64;
        for (cell, peak) in cells.iter().zip(&mut spread.peaks) {
            let count = f64::from(cell.count);
            let others = cell.sum - cell.largest;
            let degrees = (count - 1.0) * count * cells_squared;
            // If all samples agree, rounding may make it negative.
            let alone = ((cell.singles - cell.sum * cell.sum / count) / degrees).at_least(Rgb::ZERO);
            let batches = cell.count / self.batch;
            let variance = if batches < 2 || self.batch == 1 {
                alone
            } else {
                // An incomplete batch is not in the squares; the spread of complete ones gives the variance per sample.
                let (batches, sum) = (f64::from(batches), cell.sum - cell.unfinished);
                let degrees = (batches - 1.0) * f64::from(self.batch) * count * cells_squared;
                ((cell.squares - sum * sum / batches) / degrees).at_least(Rgb::ZERO)
            };
            let off = cell.largest - cell.sum / count;
            let squares = cell.singles - cell.largest * cell.largest - others * others / (count - 1.0);
            let above = cell.largest - others / (count - 1.0);
            let without = others / (count - 1.0) - cell.sum / count;
            *peak = Outlier {
                variance: (off * off / degrees).at_most(variance),
                without: mean + without / cells.len() as f64,
                brightness: cell.largest.abs().max(),
                again: squares.sum() / above.dot(above).max(f64::MIN_POSITIVE),
            };
            spread.variance += variance;
            spread.alone += alone;
            spread.others += others / ((count - 1.0) * cells.len() as f64);
            spread.samples += count;
            spread.degrees += f64::from(batches.max(1) - 1);
        }
        spread
    }
}

/// Mean over the cells with samples.
fn average(cells: &[CellSums], of: impl Fn(&CellSums) -> Rgb) -> Rgb {
    match cells {
        [one, other] if other.count > 0 => (of(one) + of(other)) / 2.0,
        _ => of(&cells[0]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::Sampler;

    /// A skewed value that needs all its bits.
    fn sample(pixel: u32, number: u32) -> Rgb {
        let mut sampler = Sampler::new(9, pixel, number);
        Rgb::new(sampler.one(0), sampler.one(1).powi(5), 1e-3 / sampler.two(2)[0])
    }

    /// Adds samples with these numbers to each cell.
    fn expose(film: &mut Film, first: u32, count: u32) {
        let (samples, cells) = (film.samples(), film.cells());
        for tile in film.extend_to(samples + count) {
            for (i, (x, y)) in tile.pixels().enumerate() {
                for (cell, number) in (0..cells).flat_map(|c| (first..first + count).map(move |n| (c, n))) {
                    tile.add(i * cells + cell, sample((y * 1000 + x) * 2 + cell as u32, number), 1.0);
                }
            }
        }
    }

    fn film(width: u32, height: u32, side: u32, batch: u32) -> Film {
        Film::new(width, height, side, batch, false, None)
    }

    #[test]
    fn passes_and_tiles_change_no_bit() {
        for batch in [1, 8] {
            let mut whole = film(13, 7, 16, batch);
            expose(&mut whole, 0, 100);
            for (side, passes) in [(16, vec![1, 1, 2, 4, 8, 16, 16, 16, 36]), (4, vec![50, 50]), (3, vec![7; 14])] {
                let mut film = film(13, 7, side, batch);
                for count in passes {
                    let first = film.samples();
                    expose(&mut film, first, count);
                }
                let first = film.samples();
                expose(&mut film, first, 100 - first);
                assert_eq!(film.means(), whole.means());
                assert_eq!(film.variances(), whole.variances());
            }
        }
    }

    #[test]
    fn films_of_blocks_append_to_the_whole() {
        for (batch, clamp) in [(1, None), (4, None), (32, None), (1, Some(0.01))] {
            let film = || Film::new(5, 5, 4, batch, false, clamp);
            let mut whole = film();
            expose(&mut whole, 0, 160);
            let mut joined = film();
            let block = 16.max(batch);
            for first in (0..160).step_by(block as usize) {
                let mut part = film();
                expose(&mut part, first, block);
                joined.append(&part);
            }
            assert_eq!(joined, whole);
        }
    }

    /// Mean of the means of whole batches, their variance over their number, and the share of the largest in it.
    fn textbook(values: &[f64], batch: usize) -> (f64, f64, f64) {
        let batches: Vec<f64> = values.chunks_exact(batch).map(|b| b.iter().sum::<f64>() / batch as f64).collect();
        let count = batches.len() as f64;
        let mean = batches.iter().sum::<f64>() / count;
        let squares: Vec<f64> = batches.iter().map(|x| (x - mean).powi(2)).collect();
        let variance = squares.iter().sum::<f64>() / (count - 1.0) / count;
        let largest = (0..batches.len()).max_by(|&a, &b| batches[a].total_cmp(&batches[b])).unwrap();
        (mean, variance, squares[largest] / (count - 1.0) / count)
    }

    #[test]
    fn mean_variance_and_peak_are_the_textbook_ones() {
        for batch in [1, 8] {
            let mut film = film(2, 1, 16, batch);
            expose(&mut film, 0, 48);
            let green: Vec<f64> = (0..48).map(|n| sample(2, n)[1]).collect();
            let (mean, variance, _) = textbook(&green, batch as usize);
            assert!((film.means()[1][1] / mean - 1.0).abs() < 1e-14);
            assert!((film.variances().unwrap()[1][1] / variance - 1.0).abs() < 1e-12);
            // The largest sample is the one with the largest channel; here all channels are equal.
            let mut grey = film_of(&green, batch);
            let mut row = [PixelStatistics::default()];
            grey.spreads(0, &mut row);
            let (_, alone, peak) = textbook(&green, 1);
            assert!((row[0].peaks[0].variance[0] / peak.min(variance) - 1.0).abs() < 1e-12);
            assert!((row[0].variance[0] / variance - 1.0).abs() < 1e-12);
            assert!((row[0].alone[0] / alone - 1.0).abs() < 1e-12);
            let others = green.iter().sum::<f64>() - green.iter().copied().fold(0.0, f64::max);
            assert!((row[0].others[0] * 47.0 / others - 1.0).abs() < 1e-12);
            assert_eq!(row[0].degrees, f64::from(48 / batch - 1));
            grey.append(&grey.clone());
            assert_eq!(grey.tiles()[0].cell(0).count, 96);
        }
    }

    /// A film of one pixel with these samples.
    fn film_of(values: &[f64], batch: u32) -> Film {
        let mut film = film(1, 1, 16, batch);
        let tile = &mut film.extend_to(values.len() as u32)[0];
        values.iter().for_each(|&value| tile.add(0, Rgb::splat(value), 1.0));
        film
    }

    #[test]
    fn an_unfinished_batch_counts_for_the_mean_and_shares_the_spread_of_the_others() {
        let mut film = film(1, 1, 16, 8);
        expose(&mut film, 0, 21);
        let green: Vec<f64> = (0..21).map(|n| sample(0, n)[1]).collect();
        assert!((film.means()[0][1] / (green.iter().sum::<f64>() / 21.0) - 1.0).abs() < 1e-14);
        let (_, of_sixteen, _) = textbook(&green, 8);
        assert!((film.variances().unwrap()[0][1] / (of_sixteen * 16.0 / 21.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn before_there_are_two_batches_samples_speak_for_themselves() {
        let mut film = film(1, 1, 16, 8);
        expose(&mut film, 0, 15);
        let green: Vec<f64> = (0..15).map(|n| sample(0, n)[1]).collect();
        let (_, alone, _) = textbook(&green, 1);
        assert!((film.variances().unwrap()[0][1] / alone - 1.0).abs() < 1e-12);
        let mut row = [PixelStatistics::default()];
        film.spreads(0, &mut row);
        assert_eq!((row[0].degrees, row[0].samples), (0.0, 15.0));
    }

    #[test]
    fn halves_count_alike_however_many_samples_they_have() {
        let mut film = Film::new(1, 1, 16, 1, true, None);
        let tile = &mut film.extend_to(4)[0];
        tile.add(0, Rgb::splat(6.0), 1.0);
        assert_eq!(film.means(), [Rgb::splat(6.0)]);
        let tile = &mut film.extend_to(4)[0];
        for value in [2.0, 4.0, 0.0] {
            tile.add(1, Rgb::splat(value), 1.0);
        }
        assert_eq!((film.means(), film.counts()), (vec![Rgb::splat(4.0)], vec![4]));
        assert_eq!(film.variances(), None);
        film.extend_to(5)[0].add(0, Rgb::splat(2.0), 1.0);
        // Variances of the two means: 8 / 2 and 4 / 3.
        assert!((film.variances().unwrap()[0][0] - (4.0 + 4.0 / 3.0) / 4.0).abs() < 1e-15);
    }

    #[test]
    fn evidence_is_of_the_samples_that_were_said_to_be() {
        let mut film = Film::new(3, 2, 2, 1, true, None);
        film.take_evidence(4);
        expose(&mut film, 0, 6);
        film.take_evidence(2);
        expose(&mut film, 6, 3);
        for half in 0..2 {
            let of = |n: u32| sample((1000 + 2) * 2 + half, n);
            let numbers = [0, 1, 2, 3, 6, 7];
            let sum: Rgb = numbers.map(of).into_iter().sum();
            let squares: Rgb = numbers.map(|n| of(n) * of(n)).into_iter().sum();
            assert_eq!(film.evidence(half as usize)[5], (sum, squares));
        }
    }

    #[test]
    fn what_is_no_light_is_counted_and_black() {
        let mut film = film(1, 1, 16, 1);
        let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 1e39];
        let tile = &mut film.extend_to(6)[0];
        for bad in bad {
            tile.add(0, Rgb::new(1.0, bad, 1.0), 1.0);
        }
        tile.add(0, Rgb::splat(f64::from(f32::MAX)), 1.0);
        assert_eq!(film.dropped(), 5);
        assert_eq!(film.means(), [Rgb::splat(f64::from(f32::MAX) / 6.0)]);
        assert!(film.variances().unwrap()[0].is_finite());
    }

    #[test]
    fn what_is_clamped_keeps_its_colour_and_is_counted() {
        let mut film = Film::new(1, 1, 16, 1, false, Some(2.0));
        let tile = &mut film.extend_to(4)[0];
        for value in [Rgb::new(8.0, 4.0, 0.0), Rgb::new(2.0, 1.0, 2.0), Rgb::ZERO, Rgb::ONE] {
            tile.add(0, value, 1.0);
        }
        assert_eq!(film.means(), [Rgb::new(5.0, 3.0, 3.0) / 4.0]);
        // Nine of twenty were removed.
        assert_eq!(film.clamped(), (1, 9.0 / 20.0));
    }

    #[test]
    fn what_is_not_asked_for_takes_no_memory() {
        // A count and five colors; three colors more with batches, two with clamping. Halves double everything and
        // add evidence: two colors and a count.
        let (count, colour) = (size_of::<u32>(), size_of::<Rgb>());
        for (batch, halves, clamp, each) in [
            (1, false, None, count + 5 * colour),
            (8, false, None, count + 8 * colour),
            (1, false, Some(1.0), count + 7 * colour),
            (1, true, None, 2 * (2 * count + 7 * colour)),
            (64, true, Some(1.0), 2 * (2 * count + 12 * colour)),
        ] {
            let mut film = Film::new(13, 7, 4, batch, halves, clamp);
            assert_eq!(film.bytes(), 13 * 7 * each);
            expose(&mut film, 0, 40);
            assert_eq!(film.bytes(), 13 * 7 * each);
        }
    }

    #[test]
    fn one_sample_has_no_error() {
        let mut film = film(1, 1, 16, 1);
        expose(&mut film, 0, 1);
        assert_eq!(film.variances(), None);
        expose(&mut film, 1, 1);
        assert!(film.variances().is_some());
    }
}
