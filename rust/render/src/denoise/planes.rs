//! Pictures of one number per pixel, row by row.

use raywright_base::parallel;
use std::ops::Range;

/// Numbers of columns and rows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Size {
    pub width: usize,
    pub height: usize,
}

/// A rectangle of pixels.
#[derive(Clone, Debug)]
pub(super) struct Area {
    pub columns: Range<usize>,
    pub rows: Range<usize>,
}

impl Size {
    pub fn pixels(self) -> usize {
        self.width * self.height
    }

    /// Square tiles with this side that cover the picture.
    pub fn tiles(self, side: usize) -> Vec<Area> {
        let pieces = |length: usize| (0..length).step_by(side).map(move |start| start..length.min(start + side));
        pieces(self.height)
            .flat_map(|rows| pieces(self.width).map(move |columns| Area { columns, rows: rows.clone() }))
            .collect()
    }
}

impl Area {
    pub fn pixels(&self) -> usize {
        self.columns.len() * self.rows.len()
    }

    /// Grows by this number of pixels on each side, within the picture.
    pub fn wider(&self, by: usize, size: Size) -> Self {
        let of = |range: &Range<usize>, length: usize| range.start.saturating_sub(by)..length.min(range.end + by);
        Self { columns: of(&self.columns, size.width), rows: of(&self.rows, size.height) }
    }

    /// The part whose pixels at this offset are within the picture.
    pub fn with(&self, [dx, dy]: [isize; 2], size: Size) -> Self {
        let of = |range: &Range<usize>, away: isize, length: usize| {
            let start = range.start.max(away.min(0).unsigned_abs());
            let end = range.end.min(length.saturating_sub(away.max(0) as usize));
            start..end.max(start)
        };
        Self { columns: of(&self.columns, dx, size.width), rows: of(&self.rows, dy, size.height) }
    }
}

/// Index of the pixel at an offset from another; both are within the picture.
#[inline]
pub(super) fn away(index: usize, [dx, dy]: [isize; 2], size: Size) -> usize {
    (index as isize + dy * size.width as isize + dx) as usize
}

/// Box filter with this radius, restricted to the picture.
pub(super) fn blurred(values: &[f64], size: Size, reach: usize) -> Vec<f64> {
    let mut across = vec![0.0; values.len()];
    let near = |at: usize, length: usize| at.saturating_sub(reach)..length.min(at + reach + 1);
    let width = size.width.max(1);
    parallel::each_chunk_mut(&mut across, width, &|first, into| {
        let row = &values[first..first + into.len()];
        for (x, into) in into.iter_mut().enumerate() {
            let near = &row[near(x, size.width)];
            *into = near.iter().sum::<f64>() / near.len() as f64;
        }
    });
    let mut all = vec![0.0; values.len()];
    parallel::each_chunk_mut(&mut all, width, &|first, into| {
        let rows = near(first / width, size.height);
        for row in rows.clone() {
            into.iter_mut().zip(&across[row * size.width..]).for_each(|(into, value)| *into += value);
        }
        into.iter_mut().for_each(|value| *value /= rows.len() as f64);
    });
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blurring_is_the_mean_of_what_is_near() {
        let size = Size { width: 7, height: 5 };
        let values: Vec<f64> = (0..35).map(|i| f64::from((i * i * 7 + i * 3) % 23)).collect();
        let blurred = blurred(&values, size, 2);
        for (i, value) in blurred.iter().enumerate() {
            let (x, y) = ((i % 7) as i32, (i / 7) as i32);
            let near: Vec<f64> = (0..35i32)
                .filter(|j| (j % 7 - x).abs() <= 2 && (j / 7 - y).abs() <= 2)
                .map(|j| values[j as usize])
                .collect();
            assert!((value - near.iter().sum::<f64>() / near.len() as f64).abs() < 1e-12);
        }
    }

    #[test]
    fn tiles_cover_all_once_and_know_where_others_are() {
        let size = Size { width: 19, height: 6 };
        let tiles = size.tiles(8);
        assert_eq!(tiles.iter().map(Area::pixels).sum::<usize>(), size.pixels());
        for tile in tiles {
            for offset in [[0, 0], [3, -2], [-7, 9], [-30, 0]] {
                let part = tile.with(offset, size);
                let is_there = |x: usize, y: usize| {
                    let [x, y] = [x as isize + offset[0], y as isize + offset[1]];
                    (0..19).contains(&x) && (0..6).contains(&y)
                };
                let all = tile.rows.clone().flat_map(|y| tile.columns.clone().map(move |x| (x, y)));
                assert_eq!(all.filter(|&(x, y)| is_there(x, y)).count(), part.pixels());
            }
        }
    }
}
