//! Tiled order of an image's rays: tiles of 8 × 8 pixels, each of four 4 × 4 quarters, so that packets are compact in
//! both directions.

use super::DVec3;

/// Side length of a tile in pixels.
const SIDE: usize = 8;

/// Side length of its quarters.
const HALF: usize = SIDE / 2;

/// Pixels per tile.
const TILE: usize = SIDE * SIDE;

/// Tiles that are read line by line together: few enough for their results to stay in the L1 cache.
const TOGETHER: usize = 1;

/// Maximum row length for tiling: a band of longer rows would be too much for one thread.
const LONGEST: usize = 1 << 14;

/// Neighboring pixels of a row that are visited consecutively.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// The position of the first pixel.
    pub place: usize,
    /// The rank of the first pixel in the order.
    pub at: usize,
    /// The number of pixels.
    pub len: usize,
}

/// An order of the pixels of an image, or of a plain sequence.
#[derive(Clone, Copy, Debug)]
pub struct Tiling {
    row: usize,
}

/// The position of the `k`-th pixel within a tile.
#[inline(always)]
fn within(k: usize) -> [usize; 2] {
    const QUARTER: usize = HALF * HALF;
    let (quarter, k) = (k / QUARTER, k % QUARTER);
    [quarter % 2 * HALF + k % HALF, quarter / 2 * HALF + k / HALF]
}

impl Tiling {
    /// The order for `count` pixels in rows of `row`. A sequence, with a `row` of 0, keeps its order. So do images with
    /// incomplete rows, and those with rows narrower than a tile or very long.
    pub fn new(count: usize, row: usize) -> Self {
        let is_image = (SIDE..=LONGEST).contains(&row) && count.is_multiple_of(row) && count / row >= SIDE;
        Self { row: if is_image { row } else { 0 } }
    }

    /// Return whether it is a plain sequence.
    pub fn is_sequence(&self) -> bool {
        self.row == 0
    }

    /// The least number of pixels, `wanted` or more, that are whole bands of tiles: images may be split there.
    pub fn chunk(&self, wanted: usize) -> usize {
        if self.row == 0 { wanted } else { wanted.next_multiple_of(SIDE * self.row) }
    }

    /// The positions of the pixels visited from rank `from`, among `count` pixels that begin with a band.
    #[inline]
    pub fn places(&self, from: usize, count: usize, places: &mut [usize]) {
        self.runs(from, places.len(), count, |run| {
            for (i, place) in places[run.at..][..run.len].iter_mut().enumerate() {
                *place = run.place + i;
            }
        });
    }

    /// The same for `some` pixels, as runs of neighbors. Whole tiles are read line by line, as they lie in memory.
    #[inline(always)]
    pub fn runs(&self, from: usize, some: usize, count: usize, mut each: impl FnMut(Run)) {
        if self.row == 0 {
            return each(Run { place: from, at: 0, len: some });
        }
        let (band, tiles, more) = (SIDE * self.row, self.row / SIDE, self.row % SIDE);
        let tiled = tiles * TILE;
        let mut at = 0;
        while at < some {
            let (i, rest) = ((from + at) % band, some - at);
            let start = from + at - i;
            // The first run, and the numbers of lines and of runs per line in whole tiles.
            let (mut lines, mut runs) = (1, 1);
            let (place, len) = if start + band > count {
                // Pixels in too few remaining rows for tiles keep their order.
                (start + i, rest)
            } else if i >= tiled {
                let (x, y) = ((i - tiled) % more, (i - tiled) / more);
                (start + y * self.row + tiles * SIDE + x, rest.min(more - x))
            } else {
                let whole = (rest / TILE).min((tiled - i) / TILE).min(TOGETHER);
                if whole > 0 && i.is_multiple_of(TILE) {
                    (lines, runs) = (SIDE, 2 * whole);
                }
                let [x, y] = within(i % TILE);
                (start + y * self.row + i / TILE * SIDE + x, rest.min(HALF - x % HALF))
            };
            for y in 0..lines {
                for run in 0..runs {
                    let quarter = run / 2 * 4 + y / HALF * 2 + run % 2;
                    let (place, at) = (place + y * self.row + run * HALF, at + (quarter * HALF + y % HALF) * HALF);
                    each(Run { place, at, len });
                }
            }
            at += len * lines * runs;
        }
    }
}

/// Guess the row length of `count` vectors that belong to an image, row by row, such as a camera's directions. Steps
/// within a row are small, and every row begins with a leap. 0 if there is no such pattern. A wrong guess merely gives
/// an arbitrary order of the rays.
pub fn row_length(count: usize, vector: impl Fn(usize) -> DVec3) -> usize {
    /// The squared ratio of a leap to a step.
    const LEAP: f64 = 64.0;
    /// Number of rows that are checked.
    const ROWS: usize = 8;
    let step = |i: usize| (vector(i + 1) - vector(i)).length_squared();
    let is_leap = |i: usize, step: f64| step > 0.0 && (vector(i + 1) - vector(i)).length_squared() > LEAP * step;
    let most = LONGEST.min(count / SIDE);
    if most < SIDE {
        return 0;
    }
    let first = step(0);
    let Some(row) = (1..most).find(|&i| is_leap(i, first)).map(|i| i + 1) else { return 0 };
    if row < SIDE || !count.is_multiple_of(row) {
        return 0;
    }
    let rows = count / row;
    let is_row = (1..ROWS).all(|k| {
        let start = (rows - 2) * k / ROWS * row;
        // A step inside the row, and a leap from its end to the next start.
        !is_leap(start + row / 2, step(start)) && is_leap(start + row - 1, step(start))
    });
    if is_row { row } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_is_visited_once_whatever_the_size() {
        for (width, height) in [(1, 1), (4, 4), (5, 7), (16, 4), (3, 20), (20, 3), (9, 11), (8, 8)] {
            for row in [0, width, 5] {
                let count = width * height;
                let tiling = Tiling::new(count, row);
                for (wanted, some) in [(1, 7), (10, 7), (10, 24), (1000, 7), (1000, 16), (1000, 1000)] {
                    let mut visits = vec![0; count];
                    for start in (0..count).step_by(tiling.chunk(wanted)) {
                        let size = tiling.chunk(wanted).min(count - start);
                        let mut places = vec![usize::MAX; size];
                        for (part, places) in places.chunks_mut(some).enumerate() {
                            tiling.places(some * part, size, places);
                        }
                        for place in places {
                            assert!(place < size);
                            visits[start + place] += 1;
                        }
                    }
                    assert!(visits.iter().all(|&n| n == 1), "{width} × {height} in rows of {row}: {visits:?}");
                }
            }
        }
    }

    #[test]
    fn places_are_the_same_however_many_are_asked_for() {
        for (width, height) in [(9, 11), (16, 8), (7, 4)] {
            let (tiling, count) = (Tiling::new(width * height, width), width * height);
            let mut all = vec![0; count];
            tiling.places(0, count, &mut all);
            for from in 0..count {
                for some in [1, 16, 19].into_iter().filter(|some| from + some <= count) {
                    let mut places = vec![0; some];
                    tiling.places(from, count, &mut places);
                    assert_eq!(places, all[from..from + some]);
                }
            }
        }
    }

    #[test]
    fn sixteen_pixels_are_a_square() {
        let tiling = Tiling::new(64, 8);
        let mut tile = [0; 16];
        tiling.places(16, 64, &mut tile);
        assert_eq!(tile, [4, 5, 6, 7, 12, 13, 14, 15, 20, 21, 22, 23, 28, 29, 30, 31]);
    }

    #[test]
    fn sixty_four_pixels_are_a_square() {
        let tiling = Tiling::new(16 * 16, 16);
        let mut tile = [0; 64];
        tiling.places(64, 256, &mut tile);
        tile.sort_unstable();
        let wanted: Vec<_> = (0..64).map(|i| i / 8 * 16 + 8 + i % 8).collect();
        assert_eq!(tile.as_slice(), wanted);
    }

    #[test]
    fn rows_of_images_are_found_and_nothing_else_is() {
        let pixel = |i: usize, row: usize| DVec3::new((i % row) as f64 + 0.5, (i / row) as f64 + 0.5, 0.0);
        for (width, height) in [(16, 16), (40, 30), (640, 480), (1000, 9), (4096, 8)] {
            let count = width * height;
            let size = height.max(width) as f64;
            let forward = DVec3::new(size / 3.0, -size / 2.0, size);
            // Directions through pixels, of any length or normalized, and origins of parallel rays.
            assert_eq!(row_length(count, |i| pixel(i, width) + forward), width);
            assert_eq!(row_length(count, |i| (pixel(i, width) + forward).normalize()), width);
            assert_eq!(row_length(count, |i| 1e-3 * pixel(i, width)), width);
            // One more or less is no image.
            assert_eq!(row_length(count + 1, |i| pixel(i, width)), 0);
        }
        // Pseudorandom digits (Steele, Lea and Flood, "Fast Splittable Pseudorandom Number Generators", 2014).
        let mixed = |i: usize| {
            let x = (i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            let x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
            (x ^ x >> 31) as f64
        };
        let scattered = |i: usize| DVec3::new(mixed(3 * i), mixed(3 * i + 1), mixed(3 * i + 2));
        for count in [0, 1, 7, 64, 10_000, 1 << 20] {
            assert_eq!(row_length(count, scattered), 0);
            assert_eq!(row_length(count, |_| DVec3::Z), 0);
            assert_eq!(row_length(count, |i| DVec3::X * i as f64), 0);
            assert_eq!(row_length(count, |_| DVec3::NAN), 0);
        }
        // A leap that does not repeat.
        assert_eq!(row_length(10_000, |i| DVec3::X * if i < 100 { i as f64 } else { i as f64 - 1000.0 }), 0);
    }
}
