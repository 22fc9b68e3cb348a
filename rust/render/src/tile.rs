//! Tiles of the film.

use super::bytes::{Malformed, Reader, Writer, check};
use super::patchwork::Patchwork;
use super::sample_buckets::{Quarters, Sums};
use raywright_optics::Rgb;

/// Sums for a mean and its error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Moments {
    /// Sum of samples.
    sum: Rgb,
    /// Sum of the squares of batch sums.
    squares: Rgb,
}

impl Moments {
    fn add(&mut self, other: &Self) {
        self.sum += other.sum;
        self.squares += other.squares;
    }
}

/// A rectangle of a film, rendered by one thread at a time.
///
/// Its cells are stored pixel by pixel, row by row: one per pixel, or two if the film is in halves.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmTile {
    corner: [u32; 2],
    size: [u32; 2],
    batch: u32,
    halves: bool,
    clamp: f64,
    /// Samples of each cell.
    counts: Vec<u32>,
    /// Sums of whole blocks of each cell.
    total: Vec<Moments>,
    /// Sums of the block being filled.
    partial: Vec<Moments>,
    /// Largest sample, by its largest channel.
    largest: Vec<Rgb>,
    /// Squares of samples of whole blocks, and of the block being filled; empty if each sample is a batch.
    singles: Vec<[Rgb; 2]>,
    /// Sum of the batch being filled; empty if each sample is a batch.
    unfinished: Vec<Rgb>,
    /// Radiance removed by clamping from whole blocks, and from the block being filled; empty without clamping.
    taken: Vec<[Rgb; 2]>,
    /// Sums of samples and their squares, and the count up to which they are kept; empty unless the film is in halves.
    evidence: Vec<(Rgb, Rgb)>,
    evidence_until: Vec<u32>,
    /// Quarters of the samples; empty unless they are kept apart.
    quarters: Quarters,
    dropped: u64,
    clamped: u64,
}

/// All sums of a cell.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CellSums {
    pub count: u32,
    pub sum: Rgb,
    pub squares: Rgb,
    /// Sum of the squares of samples.
    pub singles: Rgb,
    pub largest: Rgb,
    pub unfinished: Rgb,
    pub taken: Rgb,
    pub evidence: (Rgb, Rgb),
}

impl FilmTile {
    /// Samples summed before they are added to the total, or a batch if that is larger.
    pub(super) const BLOCK: u32 = 16;

    /// Greatest valid sample, because pictures are stored in single precision.
    const GREATEST: f64 = f32::MAX as f64;

    pub(super) fn new(corner: [u32; 2], size: [u32; 2], batch: u32, halves: bool, clamp: Option<f64>) -> Self {
        let cells = (size[0] * size[1]) as usize * if halves { 2 } else { 1 };
        let if_any = |wanted: bool| if wanted { cells } else { 0 };
        Self {
            corner,
            size,
            batch,
            halves,
            clamp: clamp.unwrap_or(f64::INFINITY),
            counts: vec![0; cells],
            total: vec![Moments::default(); cells],
            partial: vec![Moments::default(); cells],
            largest: vec![Rgb::ZERO; cells],
            singles: vec![[Rgb::ZERO; 2]; if_any(batch > 1)],
            unfinished: vec![Rgb::ZERO; if_any(batch > 1)],
            taken: vec![[Rgb::ZERO; 2]; if_any(clamp.is_some())],
            evidence: vec![(Rgb::ZERO, Rgb::ZERO); if_any(halves)],
            evidence_until: vec![0; if_any(halves)],
            quarters: Quarters::default(),
            dropped: 0,
            clamped: 0,
        }
    }

    /// Sets the tile to keep quarters apart; it must be empty.
    pub(super) fn kept_apart(self) -> Self {
        Self { quarters: Quarters::new(self.counts.len()), ..self }
    }

    /// Sums over the quarters of a cell's samples, if they are kept.
    pub(super) fn quarters(&self, cell: usize) -> Option<Sums> {
        self.quarters.of(cell)
    }

    /// Film positions of its pixels, row by row.
    pub fn pixels(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let ([left, top], [width, height]) = (self.corner, self.size);
        (top..top + height).flat_map(move |y| (left..left + width).map(move |x| (x, y)))
    }

    /// Film position of a cell's pixel.
    pub fn position(&self, cell: usize) -> (u32, u32) {
        let pixel = if self.halves { cell / 2 } else { cell } as u32;
        (self.corner[0] + pixel % self.size[0], self.corner[1] + pixel / self.size[0])
    }

    /// Its cells, patch by patch for a sample number, and one kind of cell after the other.
    pub(super) fn together(
        &self,
        patchwork: Patchwork,
        number: u32,
    ) -> impl Iterator<Item = impl Iterator<Item = usize> + use<>> + use<> {
        let (width, kinds) = (self.size[0], if self.halves { 2 } else { 1 });
        patchwork.patches(self.size, number).flat_map(move |[columns, rows]| {
            (0..kinds).map(move |kind| {
                let columns = columns.clone();
                let pixels = rows.clone().flat_map(move |y| columns.clone().map(move |x| y * width + x));
                pixels.map(move |pixel| (pixel * kinds + kind) as usize)
            })
        })
    }

    /// Numbers of columns and rows.
    pub(super) fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Samples of each cell.
    pub fn counts(&self) -> &[u32] {
        &self.counts
    }

    /// Mean of a pixel over its cells with samples; black without any.
    pub(super) fn mean(&self, pixel: usize) -> Rgb {
        let of = |cell: usize| (self.total[cell].sum + self.partial[cell].sum) / f64::from(self.counts[cell].max(1));
        match self.halves {
            true if self.counts[2 * pixel + 1] > 0 => (of(2 * pixel) + of(2 * pixel + 1)) / 2.0,
            true => of(2 * pixel),
            false => of(pixel),
        }
    }

    /// Converts the index `nth` of a sample in its cell to its number in the pixel. Halves alternate by batches, so no
    /// batch is split.
    #[inline]
    pub fn number(&self, cell: usize, nth: u32) -> u32 {
        if self.halves {
            let (batch, within) = (nth / self.batch, nth % self.batch);
            (2 * batch + (cell % 2) as u32) * self.batch + within
        } else {
            nth
        }
    }

    /// Adds the next sample of a cell: radiance times the filter's weight.
    #[inline]
    pub fn add(&mut self, cell: usize, radiance: Rgb, weight: f64) {
        self.add_run(cell, 1, |tile| tile.weighted(cell, radiance, weight));
    }

    /// A sample of a cell.
    #[inline]
    pub fn weighted(&mut self, cell: usize, radiance: Rgb, weight: f64) -> Rgb {
        self.allowed(cell, radiance) * weight
    }

    /// A sample with the contribution of light paths, which includes the filter and may be negative where the filter
    /// is.
    #[inline]
    pub fn weighted_with(&mut self, cell: usize, radiance: Rgb, weight: f64, brought: Rgb) -> Rgb {
        let brought = self.allowed(cell, brought.abs()).copysign(brought);
        self.allowed(cell, radiance) * weight + brought
    }

    /// Adds the next samples of a cell, each as a function gives it. Sums stay in registers over all of them.
    #[inline]
    pub fn add_run(&mut self, cell: usize, count: u32, mut next: impl FnMut(&mut Self) -> Rgb) {
        let (batch, block, halves) = (self.batch, Self::BLOCK.max(self.batch), self.halves);
        let first = self.counts[cell];
        let (mut of_batch, mut of_block) = (first % batch, first % block);
        let (mut partial, mut largest) = (self.partial[cell], self.largest[cell]);
        let mut unfinished = self.unfinished.get(cell).copied().unwrap_or(Rgb::ZERO);
        let mut singles = self.singles.get(cell).map_or(Rgb::ZERO, |[_, now]| *now);
        for number in first..first + count {
            let sample = next(self);
            let squares = sample * sample;
            partial.sum += sample;
            if halves && number < self.evidence_until[cell] {
                self.evidence[cell].0 += sample;
                self.evidence[cell].1 += squares;
            }
            singles += squares;
            unfinished += sample;
            of_batch += 1;
            if of_batch == batch {
                of_batch = 0;
                partial.squares += unfinished * unfinished;
                unfinished = Rgb::ZERO;
            }
            keep_largest(&mut largest, sample);
            if self.quarters.are_kept() {
                self.quarters.add(cell, sample, number / batch, halves);
            }
            of_block += 1;
            if of_block == block {
                of_block = 0;
                self.total[cell].add(&std::mem::take(&mut partial));
                if let Some([whole, _]) = self.singles.get_mut(cell) {
                    *whole += std::mem::take(&mut singles);
                }
                if let Some([whole, now]) = self.taken.get_mut(cell) {
                    *whole += std::mem::take(now);
                }
                if self.quarters.are_kept() {
                    self.quarters.end_block(cell);
                }
            }
        }
        self.counts[cell] = first + count;
        (self.partial[cell], self.largest[cell]) = (partial, largest);
        if let (Some(to), Some([_, now])) = (self.unfinished.get_mut(cell), self.singles.get_mut(cell)) {
            (*to, *now) = (unfinished, singles);
        }
    }

    /// Clamps a sample's radiance, and replaces invalid samples by black.
    #[inline]
    fn allowed(&mut self, cell: usize, radiance: Rgb) -> Rgb {
        let greatest = radiance.max();
        if !radiance.is_radiance() || greatest > Self::GREATEST {
            self.dropped += 1;
            return Rgb::ZERO;
        }
        if greatest <= self.clamp {
            return radiance;
        }
        let left = radiance * (self.clamp / greatest);
        self.clamped += 1;
        self.taken[cell][1] += radiance - left;
        left
    }

    /// Memory of its cells in bytes.
    #[cfg(test)]
    pub(super) fn bytes(&self) -> usize {
        self.counts.capacity() * size_of::<u32>()
            + (self.total.capacity() + self.partial.capacity()) * size_of::<Moments>()
            + (self.largest.capacity() + self.unfinished.capacity()) * size_of::<Rgb>()
            + (self.taken.capacity() + self.singles.capacity()) * size_of::<[Rgb; 2]>()
            + self.evidence.capacity() * size_of::<(Rgb, Rgb)>()
            + self.evidence_until.capacity() * size_of::<u32>()
            + self.quarters.bytes()
    }

    pub(super) fn dropped(&self) -> u64 {
        self.dropped
    }

    pub(super) fn clamped(&self) -> u64 {
        self.clamped
    }

    /// Minimum number of samples of a cell.
    pub(super) fn fewest(&self) -> u32 {
        self.counts.iter().copied().min().unwrap_or(u32::MAX)
    }

    pub(super) fn take_evidence(&mut self, count: u32) {
        for (until, &now) in self.evidence_until.iter_mut().zip(&self.counts) {
            *until = now + count;
        }
    }

    #[inline]
    pub(super) fn cell(&self, cell: usize) -> CellSums {
        let mut moments = self.total[cell];
        moments.add(&self.partial[cell]);
        let or_nothing = |all: &[Rgb]| all.get(cell).copied().unwrap_or(Rgb::ZERO);
        let both = |pairs: &[[Rgb; 2]]| pairs.get(cell).map(|[whole, now]| *whole + *now);
        CellSums {
            count: self.counts[cell],
            sum: moments.sum,
            squares: moments.squares,
            singles: both(&self.singles).unwrap_or(moments.squares),
            largest: self.largest[cell],
            unfinished: or_nothing(&self.unfinished),
            taken: both(&self.taken).unwrap_or(Rgb::ZERO),
            evidence: self.evidence.get(cell).copied().unwrap_or_default(),
        }
    }

    /// Appends the samples that follow those here; all blocks here are whole.
    pub(super) fn append(&mut self, next: &Self) {
        for (total, next) in self.total.iter_mut().zip(&next.total) {
            total.add(next);
        }
        for (largest, &next) in self.largest.iter_mut().zip(&next.largest) {
            keep_largest(largest, next);
        }
        for (pairs, next) in [(&mut self.taken, &next.taken), (&mut self.singles, &next.singles)] {
            for ([whole, now], next) in pairs.iter_mut().zip(next) {
                *whole += next[0];
                *now = next[1];
            }
        }
        for (count, next) in self.counts.iter_mut().zip(&next.counts) {
            *count += next;
        }
        self.partial.clone_from(&next.partial);
        self.unfinished.clone_from(&next.unfinished);
        self.quarters.append(&next.quarters);
        self.dropped += next.dropped;
        self.clamped += next.clamped;
    }

    /// Adds samples to each cell that were summed elsewhere, each a batch: by the pixel's position, their sum, the sum
    /// of their squares, and the largest.
    ///
    /// # Panics
    /// If the film is in halves, has batches of several samples, or keeps more than these sums.
    pub(super) fn add_sums(&mut self, count: u32, of: impl Fn((u32, u32)) -> [Rgb; 3]) {
        assert!(self.batch == 1 && !self.halves && self.taken.is_empty() && !self.quarters.are_kept(), "sums alone");
        for cell in 0..self.counts.len() {
            let [sum, squares, largest] = of(self.position(cell));
            self.counts[cell] += count;
            self.total[cell].add(&Moments { sum, squares });
            keep_largest(&mut self.largest[cell], largest);
        }
    }

    /// Counts samples that were dropped elsewhere.
    pub(super) fn drop_more(&mut self, count: u64) {
        self.dropped += count;
    }

    /// Maximum number of samples of a cell in serialized data, so that sums cannot overflow.
    pub(super) const MOST: u32 = u32::MAX / 4;

    /// Writes all its sums as bytes.
    pub(super) fn write(&self, to: &mut Writer) {
        to.words(self.counts.iter().copied());
        for moments in [&self.total, &self.partial] {
            to.colours(moments, |m| m.sum);
            to.colours(moments, |m| m.squares);
        }
        to.colours(&self.largest, |rgb| *rgb);
        to.colours(&self.unfinished, |rgb| *rgb);
        for part in 0..2 {
            to.colours(&self.taken, |taken| taken[part]);
            to.colours(&self.singles, |squares| squares[part]);
        }
        to.colours(&self.evidence, |(sum, _)| *sum);
        to.colours(&self.evidence, |(_, squares)| *squares);
        to.words(self.evidence_until.iter().copied());
        self.quarters.write(to);
        to.word(self.dropped);
        to.word(self.clamped);
    }

    /// Reads the sums of a tile with the same position and layout. After an error, this tile is invalid.
    pub(super) fn read(&mut self, from: &mut Reader) -> Result<(), Malformed> {
        from.words(self.counts.iter_mut())?;
        check(self.counts.iter().all(|&count| count <= Self::MOST), "a cell has too many samples")?;
        for moments in [&mut self.total, &mut self.partial] {
            from.colours(moments, |m| &mut m.sum)?;
            from.colours(moments, |m| &mut m.squares)?;
        }
        from.colours(&mut self.largest, |rgb| rgb)?;
        from.colours(&mut self.unfinished, |rgb| rgb)?;
        for part in 0..2 {
            from.colours(&mut self.taken, |taken| &mut taken[part])?;
            from.colours(&mut self.singles, |squares| &mut squares[part])?;
        }
        from.colours(&mut self.evidence, |(sum, _)| sum)?;
        from.colours(&mut self.evidence, |(_, squares)| squares)?;
        from.words(self.evidence_until.iter_mut())?;
        self.quarters.read(from)?;
        (self.dropped, self.clamped) = (from.word()?, from.word()?);
        let most = self.counts.len() as u64 * u64::from(Self::MOST);
        check(self.dropped <= most && self.clamped <= most, "more samples were dropped or clamped than taken")
    }
}

/// Keeps the sample with the larger channel by magnitude; filters may have negative weights.
#[inline]
fn keep_largest(largest: &mut Rgb, sample: Rgb) {
    if sample.abs().max() > largest.abs().max() {
        *largest = sample;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::Sampler;

    /// A skewed value that needs all its bits.
    fn sample(cell: usize, number: u32) -> Rgb {
        let mut sampler = Sampler::new(9, cell as u32, number);
        Rgb::new(sampler.one(0), sampler.one(1).powi(5), 1e-3 / sampler.two(2)[0])
    }

    #[test]
    fn runs_of_samples_add_as_each_does() {
        for (batch, halves, clamp, apart) in
            [(1, false, None, false), (8, false, None, true), (32, false, Some(0.9), false), (4, true, Some(0.9), true)]
        {
            let tile = FilmTile::new([0, 0], [2, 1], batch, halves, clamp);
            let mut each = if apart { tile.kept_apart() } else { tile };
            if halves {
                each.take_evidence(20);
            }
            let (mut runs, mut number) = (each.clone(), 0);
            for length in [1, 3, 12, 40, 0, 7, 33] {
                for cell in 0..2 {
                    let mut numbers = number..number + length;
                    numbers.clone().for_each(|number| each.add(cell, sample(cell, number), 0.5));
                    runs.add_run(cell, length, |tile| {
                        tile.weighted(cell, sample(cell, numbers.next().expect("as many")), 0.5)
                    });
                }
                number += length;
            }
            assert!(each == runs, "batches of {batch}");
            if clamp.is_none() {
                let sum: f64 = (0..number).map(|number| 0.5 * sample(0, number)[1]).sum();
                assert!((runs.cell(0).sum[1] / sum - 1.0).abs() < 1e-12);
            }
        }
    }
}
