//! Jittered grids.

use super::BatchSize;
use super::permutation::permute;
use super::stream::Stream;

/// A 64-bit number for a dimension, uniform within its own stratum.
#[inline(always)]
pub(super) fn one(size: BatchSize, stream: Stream, index: u32, dimension: u32) -> u64 {
    let stratum = permute(size, index, stream.word(dimension, 2));
    u64::from(stratum).unbounded_shl(64 - size.bits()) | stream.word_of(index, dimension, 0) >> size.bits()
}

/// Two 32-bit numbers for a dimension: one point in each cell of a grid, and one in each row and column of the fine
/// grid of 2ᵐ × 2ᵐ (Chiu, Shirley and Wang, "Multi-Jittered Sampling", 1994). All columns of cells use the same order,
/// and so do all rows (Kensler, "Correlated Multi-Jittered Sampling", 2013).
#[inline(always)]
pub(super) fn two(size: BatchSize, stream: Stream, index: u32, dimension: u32) -> [u32; 2] {
    let cell = permute(size, index, stream.word(dimension, 2));
    let columns = size.halved();
    let rows = BatchSize(size.0 - columns.0);
    let (column, row) = (cell & (columns.samples() - 1), cell >> columns.bits());
    // A column of cells has as many fine rows as there are columns of cells, and vice versa.
    let across = column << rows.bits() | permute(rows, row, stream.word(dimension, 0));
    let down = row << columns.bits() | permute(columns, column, stream.word(dimension, 1));
    let jitter = stream.word_of(index, dimension, 3);
    [(across, jitter as u32), (down, (jitter >> 32) as u32)]
        .map(|(stratum, jitter)| stratum.unbounded_shl(32 - size.bits()) | jitter >> size.bits())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::SamplerKind;

    #[test]
    fn cells_rows_and_columns_hold_one_point_each() {
        for bits in 0..=BatchSize::MOST_BITS {
            let count = 1usize << bits;
            let kind = SamplerKind::Stratified(BatchSize::new(1 << bits).unwrap());
            for (pixel, dimension) in [(0, 0), (1, 1), (2, 6), (3, 123_457)] {
                let (mut cells, mut lines) = (vec![0; count], vec![[0; 3]; count]);
                let (columns, rows) = (1 << bits.div_ceil(2), 1 << (bits / 2));
                for i in 0..1 << bits {
                    let mut sampler = kind.sampler(6, pixel, (5 << bits) + i);
                    let [x, y] = sampler.two(dimension);
                    cells[(x * f64::from(columns)) as usize * rows + (y * rows as f64) as usize] += 1;
                    for (axis, u) in [x, y, sampler.one(dimension)].into_iter().enumerate() {
                        lines[(u * count as f64) as usize][axis] += 1;
                    }
                }
                assert!(cells.iter().all(|&n| n == 1) && lines.iter().all(|&n| n == [1; 3]), "{bits}");
            }
        }
    }
}
