//! Sums over four independent parts of each pixel's samples.

use super::bytes::{Malformed, Reader, Writer};
use raywright_optics::Rgb;

/// Sums over quarters of the samples of cells, and sums of squares over the halves that they form.
///
/// Whole batches are assigned to quarters in turn, so that quarters are independent. The first two quarters of a cell
/// form one half of its samples, and the last two the other. If the film is in halves, a cell is a half and has two
/// quarters.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Quarters {
    /// Sums of whole blocks, and of the block being filled, as in a tile; empty if quarters are not kept.
    whole: Vec<Sums>,
    now: Vec<Sums>,
}

/// Sums of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sums {
    /// Sum of each quarter.
    pub sums: [Rgb; 4],
    /// Sum of squares of each half.
    pub squares: [Rgb; 2],
}

impl Sums {
    fn add(&mut self, other: &Self) {
        self.sums.iter_mut().zip(other.sums).for_each(|(sum, more)| *sum += more);
        self.squares.iter_mut().zip(other.squares).for_each(|(sum, more)| *sum += more);
    }
}

/// Quarter of a batch number, in a cell that is a half of its pixel or has two halves.
#[inline]
fn quarter_of(batch: u32, is_half: bool) -> usize {
    const TURNS: [usize; 4] = [0, 2, 1, 3];
    if is_half { (batch % 2) as usize } else { TURNS[(batch % 4) as usize] }
}

/// Samples per quarter of a cell with this many samples in batches.
pub(super) fn counts(samples: u32, batch: u32, is_half: bool) -> [u32; 4] {
    let mut counts = [0; 4];
    let turns = if is_half { 2 } else { 4 };
    let (rounds, rest) = (samples / (turns * batch), samples % (turns * batch));
    for turn in 0..turns {
        counts[quarter_of(turn, is_half)] = rounds * batch + rest.saturating_sub(turn * batch).min(batch);
    }
    counts
}

impl Quarters {
    /// Creates empty sums for a number of cells.
    pub fn new(cells: usize) -> Self {
        Self { whole: vec![Sums::default(); cells], now: vec![Sums::default(); cells] }
    }

    /// Returns whether quarters are kept.
    #[inline]
    pub fn are_kept(&self) -> bool {
        !self.now.is_empty()
    }

    /// Adds a sample of a batch.
    #[inline]
    pub fn add(&mut self, cell: usize, sample: Rgb, batch: u32, is_half: bool) {
        let (sums, quarter) = (&mut self.now[cell], quarter_of(batch, is_half));
        sums.sums[quarter] += sample;
        sums.squares[quarter / 2] += sample * sample;
    }

    /// Ends a block of a cell.
    #[inline]
    pub fn end_block(&mut self, cell: usize) {
        self.whole[cell].add(&std::mem::take(&mut self.now[cell]));
    }

    /// Total sums of a cell.
    pub fn of(&self, cell: usize) -> Option<Sums> {
        let mut sums = *self.whole.get(cell)?;
        sums.add(&self.now[cell]);
        Some(sums)
    }

    /// Appends subsequent blocks.
    pub fn append(&mut self, next: &Self) {
        self.whole.iter_mut().zip(&next.whole).for_each(|(whole, next)| whole.add(next));
        self.now.clone_from(&next.now);
    }

    /// Memory in bytes.
    #[cfg(test)]
    pub fn bytes(&self) -> usize {
        (self.whole.capacity() + self.now.capacity()) * size_of::<Sums>()
    }

    pub fn write(&self, to: &mut Writer) {
        for sums in [&self.whole, &self.now] {
            (0..4).for_each(|quarter| to.colours(sums, |sums| sums.sums[quarter]));
            (0..2).for_each(|half| to.colours(sums, |sums| sums.squares[half]));
        }
    }

    pub fn read(&mut self, from: &mut Reader) -> Result<(), Malformed> {
        for sums in [&mut self.whole, &mut self.now] {
            for quarter in 0..4 {
                from.colours(sums, |sums| &mut sums.sums[quarter])?;
            }
            for half in 0..2 {
                from.colours(sums, |sums| &mut sums.squares[half])?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_counted_where_they_go() {
        for (batch, is_half) in [(1, false), (8, false), (4, true), (16, true)] {
            let mut quarters = Quarters::new(1);
            for number in 0..100 {
                quarters.add(0, Rgb::ONE, number / batch, is_half);
                if (number + 1) % 16 == 0 {
                    quarters.end_block(0);
                }
                let expected = counts(number + 1, batch, is_half).map(f64::from).map(Rgb::splat);
                assert_eq!(quarters.of(0).unwrap().sums, expected);
            }
        }
    }
}
