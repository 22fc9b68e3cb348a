//! Interpolated numbers on a regular grid over the unit cube.

use super::Blocks;
use raywright_base::math::DVec3;
use std::ops::Range;
use std::sync::Arc;

/// Placement of a grid's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum At {
    /// Cell corners: the outermost values are on the faces of the cube.
    Corners,
    /// Cell centers: within half a cell of a face, the value is constant.
    Centres,
}

/// Numbers on a regular grid over the unit cube, `C` per point, interpolated trilinearly.
#[derive(Clone, Debug, PartialEq)]
pub struct Values<const C: usize> {
    blocks: Arc<Blocks<C>>,
    at: At,
}

impl<const C: usize> Values<C> {
    /// Creates a grid from blocks, which may be shared.
    pub fn new(blocks: Arc<Blocks<C>>, at: At) -> Self {
        Self { blocks, at }
    }

    /// Number of values along each axis.
    pub fn size(&self) -> [usize; 3] {
        self.blocks.size()
    }

    /// Converts a coordinate of the unit cube to grid coordinates, from the first value on.
    #[inline]
    fn steps(&self, axis: usize, u: f64) -> f64 {
        let last = (self.size()[axis] - 1) as f64;
        match self.at {
            At::Corners => (u * last).clamp(0.0, last),
            At::Centres => (u * self.size()[axis] as f64 - 0.5).clamp(0.0, last),
        }
    }

    /// Unclamped grid coordinates at 0 and at 1.
    pub fn line(&self, axis: usize) -> [f64; 2] {
        let count = self.size()[axis] as f64;
        match self.at {
            At::Corners => [0.0, count - 1.0],
            At::Centres => [-0.5, count - 0.5],
        }
    }

    /// Interpolated value at a point of the unit cube; points outside are clamped to it.
    #[inline]
    pub fn value(&self, point: DVec3) -> [f64; C] {
        let mut low = [0; 3];
        let mut high = [0; 3];
        let mut part = [0.0; 3];
        for axis in 0..3 {
            let steps = self.steps(axis, point[axis]);
            low[axis] = steps as usize;
            high[axis] = (low[axis] + 1).min(self.size()[axis] - 1);
            part[axis] = steps - low[axis] as f64;
        }
        let mut sum = [0.0; C];
        let Some(corners) = self.blocks.cell(low, high) else { return sum };
        let mut corner = corners.iter();
        for wx in [1.0 - part[0], part[0]] {
            for wy in [1.0 - part[1], part[1]] {
                for wz in [1.0 - part[2], part[2]] {
                    let weight = wx * wy * wz;
                    for (sum, &value) in sum.iter_mut().zip(corner.next().expect("a cell has eight corners")) {
                        *sum += weight * f64::from(value);
                    }
                }
            }
        }
        sum
    }

    /// Interpolated values between two points in the same cell: coefficients of a polynomial in the position, the
    /// constant first.
    #[inline]
    pub fn cubic(&self, ends: [DVec3; 2]) -> [[f64; C]; 4] {
        let (mut low, mut high) = ([0; 3], [0; 3]);
        // Position in the cell where the segment begins, and its length there.
        let (mut from, mut by) = ([0.0; 3], [0.0; 3]);
        for axis in 0..3 {
            let (start, end) = (self.steps(axis, ends[0][axis]), self.steps(axis, ends[1][axis]));
            // Rounding may place an end slightly beyond a border, but not the middle.
            low[axis] = (0.5 * (start + end)) as usize;
            high[axis] = (low[axis] + 1).min(self.size()[axis] - 1);
            (from[axis], by[axis]) = (start - low[axis] as f64, end - start);
        }
        let mut terms = [[0.0; C]; 4];
        let Some(corners) = self.blocks.cell(low, high) else { return terms };
        for channel in 0..C {
            let value = |corner: usize| f64::from(corners[corner][channel]);
            // Interpolation along the last axis is linear; each further axis raises the degree by one.
            let line = |i: usize| {
                let slope = value(i + 1) - value(i);
                [value(i) + slope * from[2], slope * by[2]]
            };
            let square = |i: usize| {
                let ([a, b], [c, d]) = (line(i), line(i + 2));
                [a + (c - a) * from[1], b + (d - b) * from[1] + (c - a) * by[1], (d - b) * by[1]]
            };
            let ([a, b, c], [d, e, f]) = (square(0), square(4));
            let (p, q, r) = (d - a, e - b, f - c);
            terms[0][channel] = a + p * from[0];
            terms[1][channel] = b + q * from[0] + p * by[0];
            terms[2][channel] = c + r * from[0] + q * by[0];
            terms[3][channel] = r * by[0];
        }
        terms
    }

    /// Minimum and maximum of each number in equal blocks of the unit cube, the last axis fastest.
    pub fn ranges(&self, blocks: [usize; 3]) -> impl Iterator<Item = [[f32; C]; 2]> + '_ {
        // Indices that affect a block: those within, and the next on either side.
        let counting = move |axis: usize, block: usize| -> Range<usize> {
            let [from, to] = [block, block + 1].map(|b| self.steps(axis, b as f64 / blocks[axis] as f64));
            // Widened for values that rounding may have moved to the other side.
            let last = (self.size()[axis] - 1) as f64;
            let [from, to] = [from * (1.0 - 1e-12), (to * (1.0 + 1e-12)).min(last)];
            from.floor() as usize..to.ceil() as usize + 1
        };
        (0..blocks.iter().product()).map(move |block| {
            let [x, y, z] = [block / blocks[2] / blocks[1], block / blocks[2] % blocks[1], block % blocks[2]];
            self.blocks.range([counting(0, x), counting(1, y), counting(2, z)])
        })
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        self.blocks.bytes()
    }
}
