//! Four independent parts of each pixel's samples, kept apart.

use super::bytes::{Malformed, Reader, Writer};
use raywright_optics::Rgb;

/// Sums over the quarters of the samples of cells, and of the squares of samples over the halves that these make.
///
/// Whole batches go to quarters in turns, so that no two quarters share anything. The first two of a cell make one half
/// of its samples and the last two the other; of a film that is in halves already, a cell is a half, and has two
/// quarters.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Quarters {
    /// Those of whole blocks, and of the one that is being filled, as a tile has it; empty if nothing is kept apart.
    whole: Vec<Sums>,
    now: Vec<Sums>,
}

/// Those of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sums {
    /// Of each quarter.
    pub sums: [Rgb; 4],
    /// The squares of samples, of each half.
    pub squares: [Rgb; 2],
}

impl Sums {
    fn add(&mut self, other: &Self) {
        self.sums.iter_mut().zip(other.sums).for_each(|(sum, more)| *sum += more);
        self.squares.iter_mut().zip(other.squares).for_each(|(sum, more)| *sum += more);
    }
}

/// The quarter that batches of a number go to, of a cell that is a half of its pixel or has two.
#[inline]
fn quarter_of(batch: u32, is_half: bool) -> usize {
    const TURNS: [usize; 4] = [0, 2, 1, 3];
    if is_half { (batch % 2) as usize } else { TURNS[(batch % 4) as usize] }
}

/// How many samples each quarter of a cell has, of so many in batches.
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
    /// Those of so many cells without samples.
    pub fn new(cells: usize) -> Self {
        Self { whole: vec![Sums::default(); cells], now: vec![Sums::default(); cells] }
    }

    /// Whether anything is kept.
    #[inline]
    pub fn are_kept(&self) -> bool {
        !self.now.is_empty()
    }

    /// Counts in a sample of a batch.
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

    /// All of a cell.
    pub fn of(&self, cell: usize) -> Option<Sums> {
        let mut sums = *self.whole.get(cell)?;
        sums.add(&self.now[cell]);
        Some(sums)
    }

    /// Counts in the blocks that follow.
    pub fn append(&mut self, next: &Self) {
        self.whole.iter_mut().zip(&next.whole).for_each(|(whole, next)| whole.add(next));
        self.now.clone_from(&next.now);
    }

    /// The memory held for them.
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
