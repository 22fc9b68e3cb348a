//! The rays of an image in tiles of 4 × 4 pixels: neighbours in both directions, not along rows alone, share a packet.

/// Pixels on a tile's side.
const SIDE: usize = 4;

/// Pixels of a tile.
const TILE: usize = SIDE * SIDE;

/// Rows longer than this are not cut into tiles: a band of them would be too much for one thread.
const LONGEST: usize = 1 << 14;

/// An order of the pixels of an image, or of a plain sequence.
#[derive(Clone, Copy, Debug)]
pub struct Tiling {
    row: usize,
}

impl Tiling {
    /// For an image of `count` pixels in rows of `row`. A sequence, whose `row` is 0, keeps its order, as does what
    /// does not divide into rows, or divides into rows narrower than a tile or very long.
    pub fn new(count: usize, row: usize) -> Self {
        let is_image = (SIDE..=LONGEST).contains(&row) && count.is_multiple_of(row) && count / row >= SIDE;
        Self { row: if is_image { row } else { 0 } }
    }

    /// Whether it is a plain sequence, whose order is its own.
    pub fn is_sequence(&self) -> bool {
        self.row == 0
    }

    /// The least number of pixels, `wanted` or more, that are whole bands of tiles: an image may be cut after so many.
    pub fn chunk(&self, wanted: usize) -> usize {
        if self.row == 0 { wanted } else { wanted.next_multiple_of(SIDE * self.row) }
    }

    /// Where the pixels lie that are visited `from`-th and next, among `count` that begin with a band.
    #[inline]
    pub fn places(&self, from: usize, count: usize, places: &mut [usize]) {
        if self.row == 0 {
            for (i, place) in places.iter_mut().enumerate() {
                *place = from + i;
            }
            return;
        }
        let (band, tiles, more) = (SIDE * self.row, self.row / SIDE, self.row % SIDE);
        let tiled = tiles * TILE;
        // Carried along from pixel to pixel, since a division for each would show in the time of a ray.
        let (mut start, mut i) = (from / band * band, from % band);
        let mut rest = places;
        while !rest.is_empty() {
            if i == band {
                (start, i) = (start + band, 0);
            }
            // Where too few rows are left for tiles, pixels keep their order.
            let is_tiled = start + band <= count && i < tiled;
            if is_tiled
                && i.is_multiple_of(TILE)
                && let Some(tile) = rest.first_chunk_mut::<TILE>()
            {
                // A whole tile at once: pixel by pixel would show as well.
                for (k, place) in tile.iter_mut().enumerate() {
                    *place = start + i / SIDE + k / SIDE * self.row + k % SIDE;
                }
                i += TILE;
                rest = &mut rest[TILE..];
                continue;
            }
            let (x, y) = if is_tiled {
                (i / TILE * SIDE + i % SIDE, i / SIDE % SIDE)
            } else if start + band <= count {
                (tiles * SIDE + (i - tiled) % more, (i - tiled) / more)
            } else {
                (i, 0)
            };
            rest[0] = start + y * self.row + x;
            i += 1;
            rest = &mut rest[1..];
        }
    }
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
}
