//! What samples add up to.

use crate::optics::{Rgb, is_radiance};

/// Sums from which a mean and its error are had.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// Sum of samples.
    pub sum: Rgb,
    /// Sum of the squares of batches' sums.
    pub squares: Rgb,
}

impl Moments {
    fn add(&mut self, other: &Self) {
        self.sum += other.sum;
        self.squares += other.squares;
    }
}

/// The samples of a picture so far: for each pixel and channel their sum, and what it takes to know its error.
///
/// The error comes from the spread of *batches* of samples that are independent of each other. A batch is one sample
/// where all are independent, and several where they are placed with regard to each other.
///
/// Sums depend on the order of adding, so the order is part of the film: samples are added up one by one in blocks of
/// 16, and blocks one by one. Hence how samples are split into passes, who works on a tile and how large tiles are does
/// not change a bit, and neither does [`Film::append`] with films of single blocks, wherever these were made.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    width: u32,
    height: u32,
    batch: u32,
    samples: u32,
    tiles: Vec<FilmTile>,
}

/// A rectangle of a film, which one thread works on at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmTile {
    left: u32,
    top: u32,
    width: u32,
    height: u32,
    batch: u32,
    /// Whole blocks, of each pixel.
    total: Vec<Moments>,
    /// The block that is being filled.
    partial: Vec<Moments>,
    /// The batch that is being filled; empty if each sample is one.
    unfinished: Vec<Rgb>,
    dropped: u64,
}

impl Film {
    /// Samples that are added up before they are added to the total, or a batch if that is more.
    const BLOCK: u32 = 16;

    /// The greatest sample that counts: pictures are stored in single precision, in which more would be infinite.
    const GREATEST: f64 = f32::MAX as f64;

    /// An empty film in square tiles, for batches of samples.
    pub fn new(width: u32, height: u32, tile: u32, batch: u32) -> Self {
        assert!(tile > 0 && batch.is_power_of_two(), "tiles hold pixels, and batches fill blocks");
        let mut tiles = Vec::new();
        for top in (0..height).step_by(tile as usize) {
            for left in (0..width).step_by(tile as usize) {
                let (w, h) = (tile.min(width - left), tile.min(height - top));
                let pixels = (w * h) as usize;
                tiles.push(FilmTile {
                    left,
                    top,
                    width: w,
                    height: h,
                    batch,
                    total: vec![Moments::default(); pixels],
                    partial: vec![Moments::default(); pixels],
                    unfinished: vec![Rgb::ZERO; if batch > 1 { pixels } else { 0 }],
                    dropped: 0,
                });
            }
        }
        Self { width, height, batch, samples: 0, tiles }
    }

    /// Pixels in a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Samples of each pixel.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Independent batches that the samples make.
    pub fn batches(&self) -> u32 {
        self.samples / self.batch
    }

    /// Samples that were NaN, infinite or negative, and count as black.
    pub fn dropped(&self) -> u64 {
        self.tiles.iter().map(|t| t.dropped).sum()
    }

    /// The tiles, to be filled with `count` more samples of each of their pixels.
    pub fn extend(&mut self, count: u32) -> &mut [FilmTile] {
        self.samples += count;
        &mut self.tiles
    }

    /// Adds the samples that follow those here.
    ///
    /// # Panics
    /// If the films differ in shape, or the last block here is not full.
    pub fn append(&mut self, next: &Self) {
        let shape = |f: &Self| (f.width, f.height, f.batch, f.tiles.len());
        assert_eq!(shape(self), shape(next), "films of one shape");
        assert!(self.samples.is_multiple_of(Self::BLOCK.max(self.batch)), "whole blocks");
        self.samples += next.samples;
        for (tile, next) in self.tiles.iter_mut().zip(&next.tiles) {
            for (total, next) in tile.total.iter_mut().zip(&next.total) {
                total.add(next);
            }
            tile.partial.clone_from(&next.partial);
            tile.unfinished.clone_from(&next.unfinished);
            tile.dropped += next.dropped;
        }
    }

    /// Something of each pixel, row by row from the top.
    fn pixels<T: Clone + Default>(&self, of: impl Fn(Moments) -> T) -> Vec<T> {
        let mut all = vec![T::default(); self.width as usize * self.height as usize];
        for tile in &self.tiles {
            for (i, (x, y)) in tile.pixels().enumerate() {
                let mut moments = tile.total[i];
                moments.add(&tile.partial[i]);
                all[y as usize * self.width as usize + x as usize] = of(moments);
            }
        }
        all
    }

    /// The mean of each pixel; black without samples.
    pub fn means(&self) -> Vec<Rgb> {
        let count = f64::from(self.samples.max(1));
        self.pixels(|m| m.sum / count)
    }

    /// The estimated variance of each pixel's mean, unbiased; `None` below two batches, which say nothing of it.
    pub fn variances(&self) -> Option<Vec<Rgb>> {
        assert!(self.samples.is_multiple_of(self.batch), "whole batches");
        let batches = f64::from(self.batches());
        (batches >= 2.0).then(|| {
            let degrees = batches * (batches - 1.0) * f64::from(self.batch).powi(2);
            // Where all samples agree, rounding may leave less than nothing.
            self.pixels(|m| ((m.squares - m.sum * m.sum / batches) / degrees).max(Rgb::ZERO))
        })
    }
}

impl FilmTile {
    /// The positions of its pixels on the film, row by row.
    pub fn pixels(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let (left, top, width, height) = (self.left, self.top, self.width, self.height);
        (top..top + height).flat_map(move |y| (left..left + width).map(move |x| (x, y)))
    }

    /// Adds sample number `number` of the pixel at this index of [`FilmTile::pixels`], times the weight that its filter gives it,
    /// which may be negative. Those of a pixel come in order.
    #[inline]
    pub fn add(&mut self, pixel: usize, number: u32, radiance: Rgb, weight: f64) {
        let mut sample = radiance * weight;
        if !is_radiance(radiance) || sample.abs().max_element() > Film::GREATEST {
            self.dropped += 1;
            sample = Rgb::ZERO;
        }
        let partial = &mut self.partial[pixel];
        partial.sum += sample;
        if self.batch == 1 {
            partial.squares += sample * sample;
        } else {
            let unfinished = &mut self.unfinished[pixel];
            *unfinished += sample;
            if (number + 1).is_multiple_of(self.batch) {
                partial.squares += *unfinished * *unfinished;
                *unfinished = Rgb::ZERO;
            }
        }
        if (number + 1).is_multiple_of(Film::BLOCK.max(self.batch)) {
            self.total[pixel].add(partial);
            *partial = Moments::default();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Sampler;

    /// Something skewed that needs all its bits.
    fn sample(pixel: u32, number: u32) -> Rgb {
        let mut sampler = Sampler::new(9, pixel, number);
        Rgb::new(sampler.one(0), sampler.one(1).powi(5), 1e-3 / sampler.two(2)[0])
    }

    fn expose(film: &mut Film, first: u32, count: u32) {
        for tile in film.extend(count) {
            for (i, (x, y)) in tile.pixels().enumerate() {
                for number in first..first + count {
                    tile.add(i, number, sample(y * 1000 + x, number), 1.0);
                }
            }
        }
    }

    #[test]
    fn passes_and_tiles_change_no_bit() {
        let mut whole = Film::new(13, 7, 16, 1);
        expose(&mut whole, 0, 100);
        for (tile, passes) in [(16, vec![1, 1, 2, 4, 8, 16, 16, 16, 36]), (4, vec![50, 50]), (3, vec![7; 14])] {
            let mut film = Film::new(13, 7, tile, 1);
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

    #[test]
    fn films_of_blocks_append_to_the_whole() {
        for batch in [1, 4, 32] {
            let mut whole = Film::new(5, 5, 4, batch);
            expose(&mut whole, 0, 160);
            let mut joined = Film::new(5, 5, 4, batch);
            let block = 16.max(batch);
            for first in (0..160).step_by(block as usize) {
                let mut part = Film::new(5, 5, 4, batch);
                expose(&mut part, first, block);
                joined.append(&part);
            }
            assert_eq!(joined, whole);
        }
    }

    #[test]
    fn mean_and_variance_are_the_textbook_ones() {
        for batch in [1, 8] {
            let mut film = Film::new(2, 1, 16, batch);
            expose(&mut film, 0, 48);
            let batches: Vec<f64> = (0..48 / batch)
                .map(|b| (0..batch).map(|i| sample(1, b * batch + i).y).sum::<f64>() / f64::from(batch))
                .collect();
            let count = batches.len() as f64;
            let mean = batches.iter().sum::<f64>() / count;
            let variance = batches.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0) / count;
            assert!((film.means()[1].y / mean - 1.0).abs() < 1e-14);
            assert!((film.variances().unwrap()[1].y / variance - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn what_is_no_light_is_counted_and_black() {
        let mut film = Film::new(1, 1, 16, 1);
        let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 1e39];
        let tile = &mut film.extend(6)[0];
        for (number, bad) in bad.into_iter().enumerate() {
            tile.add(0, number as u32, Rgb::new(1.0, bad, 1.0), 1.0);
        }
        tile.add(0, 5, Rgb::splat(f64::from(f32::MAX)), 1.0);
        assert_eq!(film.dropped(), 5);
        assert_eq!(film.means(), [Rgb::splat(f64::from(f32::MAX) / 6.0)]);
        assert!(film.variances().unwrap()[0].is_finite());
    }

    #[test]
    fn one_sample_has_no_error() {
        let mut film = Film::new(1, 1, 16, 1);
        expose(&mut film, 0, 1);
        assert_eq!(film.variances(), None);
        expose(&mut film, 1, 1);
        assert!(film.variances().is_some());
    }
}
