//! Sorting of rays for coherence, by origin or direction.
//!
//! Rays that leave a surface are in the order of the pixels, row by row, so a packet of them is a long thin strip. The
//! bounding box of some thousand origins is bisected along its longest side, and so are its parts, until there are as
//! many cells as a table holds. The rays are then sorted by cell with a counting sort. (Pharr, Kolb, Gershbein and
//! Hanrahan, "Rendering Complex Scenes with Memory-Coherent Ray Tracing", 1997, queue rays by location.)
//!
//! Runs of four neighbors stay together: sorting single rays takes four times as long, and does not speed up tracing.

use std::array::from_fn;

/// Neighbors that stay together.
pub const RUN: usize = 4;

/// Maximum number of rays sorted together: some rows of a picture. (Half as many are traced up to a twentieth slower,
/// an eighth up to a fifth.)
pub const WINDOW: usize = 16384;

/// Number of bisections.
const BITS: u32 = 12;

/// Maximum number of bisections along one axis.
const ALONG: u32 = 8;

/// Coordinate types of vectors.
pub trait Coordinate: Copy + Default {
    /// Round to f32.
    fn single(self) -> f32;
}

impl Coordinate for f32 {
    #[inline(always)]
    fn single(self) -> f32 {
        self
    }
}

impl Coordinate for f64 {
    #[inline(always)]
    fn single(self) -> f32 {
        self as f32
    }
}

/// The first vector of each run, in f32.
#[inline(always)]
fn firsts<T: Coordinate>(vectors: &[[T; 3]]) -> impl Iterator<Item = [f32; 3]> {
    vectors.as_chunks::<RUN>().0.iter().map(|run| run[0].map(T::single))
}

/// The bounding box of the first vectors of runs.
#[derive(Clone, Copy, Debug)]
pub struct RunBounds {
    low: [f32; 3],
    size: [f32; 3],
    /// The largest absolute coordinate.
    farthest: f32,
}

impl RunBounds {
    /// Compute it, ignoring NaN.
    pub fn of<T: Coordinate>(vectors: &[[T; 3]]) -> Self {
        let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for vector in firsts(vectors) {
            for axis in 0..3 {
                low[axis] = if vector[axis] < low[axis] { vector[axis] } else { low[axis] };
                high[axis] = if vector[axis] > high[axis] { vector[axis] } else { high[axis] };
            }
        }
        let farthest = (0..3).map(|axis| low[axis].abs().max(high[axis].abs())).fold(0.0, f32::max);
        Self { low, size: from_fn(|axis| high[axis] - low[axis]), farthest }
    }

    /// The longest side over `extent` or, if none is given, over the largest absolute coordinate.
    pub fn over(&self, extent: Option<f64>) -> f32 {
        let longest = self.size.into_iter().fold(0.0, f32::max);
        longest / extent.map_or(self.farthest, |extent| extent as f32)
    }
}

/// Sorts up to [`WINDOW`] vectors.
#[derive(Debug, Default)]
pub struct Gathering {
    order: Vec<u16>,
    cells: Vec<u16>,
    counts: Vec<u16>,
}

impl Gathering {
    /// Sort the runs of vectors, at most [`WINDOW`], within a box; return the order of the runs. An incomplete last run
    /// is omitted.
    pub fn of<T: Coordinate>(&mut self, vectors: &[[T; 3]], spread: &RunBounds) -> &[u16] {
        assert!(vectors.len() <= WINDOW, "{} vectors", vectors.len());
        // The bits of a cell, by axis and position along it.
        let mut bits = [[0u16; 1 << ALONG]; 3];
        let mut halved = [0u32; 3];
        let mut size = spread.size;
        for bit in (0..BITS).rev() {
            // Only axes with room in their table, also if all sides are equal or zero.
            let open = (0..3).filter(|&axis| halved[axis] < ALONG);
            let longer = |best: usize, axis: usize| if size[axis] > size[best] { axis } else { best };
            let longest = open.reduce(longer).expect("fewer bits than all tables have");
            // Both halves inherit the bits of their parent.
            let to = &mut bits[longest];
            for place in (0..1 << halved[longest]).rev() {
                (to[2 * place], to[2 * place + 1]) = (to[place], to[place] | 1 << bit);
            }
            halved[longest] += 1;
            size[longest] /= 2.0;
        }
        // Adding this rounds to an integer in the last bits.
        const WHOLE: f32 = (1 << 23) as f32;
        let scale: [f32; 3] =
            from_fn(|axis| ((1 << halved[axis]) - 1) as f32 / spread.size[axis].max(f32::MIN_POSITIVE));
        let Self { order, cells, counts } = self;
        cells.clear();
        cells.extend(firsts(vectors).map(|vector| {
            let place = |axis: usize| ((vector[axis] - spread.low[axis]) * scale[axis] + WHOLE).to_bits() as usize;
            let bits = |axis: usize| bits[axis][place(axis) & ((1 << ALONG) - 1)];
            bits(0) | bits(1) | bits(2)
        }));
        counts.clear();
        counts.resize(1 << BITS, 0);
        for &cell in &*cells {
            counts[usize::from(cell) & ((1 << BITS) - 1)] += 1;
        }
        let mut before = 0;
        for count in &mut *counts {
            (*count, before) = (before, before + *count);
        }
        order.resize(cells.len(), 0);
        for (i, &cell) in cells.iter().enumerate() {
            let at = &mut counts[usize::from(cell) & ((1 << BITS) - 1)];
            order[usize::from(*at)] = i as u16;
            *at += 1;
        }
        order
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points on a wavy surface, row by row.
    fn surface(width: usize, height: usize) -> Vec<[f32; 3]> {
        let point = |i: usize| {
            let (x, y) = ((i % width) as f32, (i / width) as f32);
            [x, y, 10.0 * (x / 100.0).sin() * (y / 100.0).cos()]
        };
        (0..width * height).map(point).collect()
    }

    fn gathered<T: Coordinate>(vectors: &[[T; 3]]) -> Vec<u16> {
        Gathering::default().of(vectors, &RunBounds::of(vectors)).to_vec()
    }

    #[test]
    fn every_run_stands_somewhere_whatever_the_vectors_are() {
        let number = |i: usize| [0.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -1e-40, 7.0][i * i % 7];
        let mut gathering = Gathering::default();
        for count in [0, 1, 3, 4, 5, 8, 100, 4099, WINDOW] {
            let strange: Vec<_> = (0..count).map(|i| [number(i), number(i + 1), number(3 * i)]).collect();
            let same = vec![[1.0f32, 2.0, 3.0]; count];
            for vectors in [strange, same, surface(1024, WINDOW / 1024)[..count].to_vec()] {
                let mut order = gathering.of(&vectors, &RunBounds::of(&vectors)).to_vec();
                order.sort_unstable();
                assert!(order.into_iter().eq((0..count / RUN).map(|run| run as u16)), "{count} vectors");
            }
        }
    }

    #[test]
    fn those_that_stand_together_are_near_each_other() {
        for (width, height) in [(1024, 8), (300, 27), (1024, 16)] {
            let vectors = surface(width, height);
            let double: Vec<_> = vectors.iter().map(|v| v.map(f64::from)).collect();
            let order = gathered(&vectors);
            assert_eq!(order, gathered(&double));
            // Sixteen runs, as in a packet of rays.
            let side = |runs: &[u16]| -> f32 {
                let some: Vec<_> = runs.iter().map(|&run| vectors[RUN * usize::from(run)]).collect();
                let of = |axis: usize| some.iter().map(move |v| v[axis]);
                let size = |axis| of(axis).fold(f32::MIN, f32::max) - of(axis).fold(f32::MAX, f32::min);
                (0..3).map(size).fold(0.0, f32::max)
            };
            let sides: Vec<_> = order.chunks_exact(16).map(side).collect();
            // Unsorted packets are 60 long, and some wrap around the end of a row.
            let mean = sides.iter().sum::<f32>() / sides.len() as f32;
            assert!(mean < 20.0, "{width} × {height}: {mean}");
        }
    }

    #[test]
    fn a_box_says_how_far_apart_they_are() {
        let spread = RunBounds::of(&[[1.0, 2.0, 3.0], [9.0; 3], [9.0; 3], [9.0; 3], [-4.0, f64::NAN, 3.5]]);
        // Only the first of each run counts, and an incomplete run has none.
        assert_eq!((spread.over(Some(2.0)), spread.over(None)), (0.0, 0.0));
        let spread = RunBounds::of(&surface(1024, 2));
        assert_eq!((spread.over(Some(10.0)), spread.over(None)), (102.0, 1.0));
    }
}
