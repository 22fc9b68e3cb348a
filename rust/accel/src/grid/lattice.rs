//! The geometry of grid cells, and the bit set of nonempty ones.

use super::PAD;
use raywright_base::math::{Aabb, DVec3, Vec3};

/// A box divided into equal cells. Cell (x, y, z) has the index x + nₓ · (y + n_y · z).
#[derive(Clone, Copy, Debug)]
pub struct Lattice {
    /// The position of the first plane of each axis, in box units.
    pub low: [f32; 3],
    /// The distance between planes.
    pub width: [f32; 3],
    /// The number of cells along each axis.
    pub cells: [u32; 3],
}

impl Lattice {
    /// Divide a box that is larger than `bounds` by at least twice [`PAD`] on every side.
    pub fn around(bounds: &Aabb, cells: [u32; 3]) -> Self {
        // The third PAD covers rounding, which is less than a hundredth of it.
        let room = Vec3::splat(3.0 * PAD);
        let (low, high) = ((bounds.min - room).to_array(), (bounds.max + room).to_array());
        let width = |axis: usize| ((high[axis] - low[axis]) / cells[axis] as f32).next_up();
        Self { low, width: [0, 1, 2].map(width), cells }
    }

    /// The number of cells.
    pub fn count(&self) -> usize {
        self.cells.iter().map(|&n| n as usize).product()
    }

    /// The index increments along each axis.
    #[inline(always)]
    pub fn strides(&self) -> [usize; 3] {
        let [x, y, _] = self.cells.map(|n| n as usize);
        [1, x, x * y]
    }

    /// The index of a cell.
    #[inline(always)]
    pub fn number(&self, cell: [u32; 3]) -> usize {
        let [x, y, z] = cell.map(|i| i as usize);
        x + self.cells[0] as usize * (y + self.cells[1] as usize * z)
    }

    /// The cell of an index.
    pub fn cell(&self, number: usize) -> [u32; 3] {
        let [x, y, _] = self.cells.map(|n| n as usize);
        [number % x, number / x % y, number / (x * y)].map(|i| i as u32)
    }

    /// The position of a plane, to a relative error of 2⁻⁵².
    #[inline(always)]
    fn plane(&self, axis: usize, i: u32) -> f64 {
        f64::from(self.low[axis]) + f64::from(i) * f64::from(self.width[axis])
    }

    /// The center of a cell.
    #[inline(always)]
    pub fn middle(&self, cell: [u32; 3]) -> DVec3 {
        let [x, y, z] = [0, 1, 2].map(|a| self.plane(a, cell[a]) + 0.5 * f64::from(self.width[a]));
        DVec3::new(x, y, z)
    }

    /// The box of a range of cells, widened by [`PAD`] to within a rounding.
    #[inline]
    pub fn aabb(&self, from: [u32; 3], to: [u32; 3]) -> Aabb {
        let corner = |cell: [u32; 3], more: u32, pad: f64| {
            Vec3::from([0, 1, 2].map(|a| (self.plane(a, cell[a] + more) + pad) as f32))
        };
        Aabb { min: corner(from, 0, -f64::from(PAD)), max: corner(to, 1, f64::from(PAD)) }
    }

    /// The first and the last cell that overlap a box when widened by [`PAD`]; None if no cell does. PAD's reserve is
    /// far larger than the f64 rounding here.
    #[inline]
    pub fn range(&self, aabb: &Aabb) -> Option<([u32; 3], [u32; 3])> {
        let (mut from, mut to) = ([0; 3], [0; 3]);
        for axis in 0..3 {
            let (low, per_cell) = (f64::from(self.low[axis]), 1.0 / f64::from(self.width[axis]));
            let least = (f64::from(aabb.min[axis] - PAD) - low) * per_cell;
            let most = (f64::from(aabb.max[axis] + PAD) - low) * per_cell;
            // Nonnegative numbers are truncated, since `floor` would be a function call.
            if most < 0.0 {
                return None;
            }
            let (least, most, last) = (least as i64, most as i64, i64::from(self.cells[axis]) - 1);
            if least > last || least > most {
                return None;
            }
            (from[axis], to[axis]) = (least.max(0) as u32, most.min(last) as u32);
        }
        Some((from, to))
    }

    /// Half the surface area of a cell.
    pub fn cell_area(&self) -> f64 {
        let [x, y, z] = self.width.map(f64::from);
        x * (y + z) + y * z
    }

    /// Half the surface area of the whole grid.
    pub fn area(&self) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|a| f64::from(self.width[a]) * f64::from(self.cells[a]));
        x * (y + z) + y * z
    }
}

/// A bit set of nonempty cells with rank queries. One bit per cell fits many cells into the inner caches.
#[derive(Clone, Debug, Default)]
pub struct Occupied {
    bits: Vec<u64>,
    before: Vec<u32>,
}

impl Occupied {
    /// Append a grid's cells, given their numbers of primitives. Each grid starts at a new word.
    pub fn push(&mut self, counts: &[u32]) {
        let mut before = self.count();
        for counts in counts.chunks(64) {
            let bits = counts.iter().enumerate().fold(0, |bits, (i, &n)| bits | u64::from(n > 0) << i);
            self.bits.push(bits);
            self.before.push(before);
            before += bits.count_ones();
        }
    }

    /// The number of words.
    pub fn words(&self) -> usize {
        self.bits.len()
    }

    /// The number of nonempty cells.
    pub fn count(&self) -> u32 {
        match (self.bits.last(), self.before.last()) {
            (Some(bits), Some(before)) => before + bits.count_ones(),
            _ => 0,
        }
    }

    /// Return whether a cell is nonempty; `word` is the grid's first word.
    #[inline(always)]
    pub fn has(&self, word: usize, cell: usize) -> bool {
        self.bits[word + cell / 64] >> (cell % 64) & 1 != 0
    }

    /// Return whether any cell in `from..to` is nonempty.
    #[inline]
    pub fn has_any(&self, word: usize, from: usize, to: usize) -> bool {
        from < to && self.rank(word, to - 1) + u32::from(self.has(word, to - 1)) > self.rank(word, from)
    }

    /// The number of nonempty cells before a cell.
    #[inline(always)]
    pub fn rank(&self, word: usize, cell: usize) -> u32 {
        let below = (1u64 << (cell % 64)) - 1;
        self.before[word + cell / 64] + (self.bits[word + cell / 64] & below).count_ones()
    }

    /// Memory use in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.bits.as_slice()) + size_of_val(self.before.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_have_numbers_and_places() {
        let bounds = Aabb { min: Vec3::new(-1.0, 0.0, 0.5), max: Vec3::new(1.0, 1.5, 0.9) };
        let lattice = Lattice::around(&bounds, [7, 5, 3]);
        assert_eq!(lattice.count(), 105);
        let [dx, dy, dz] = lattice.strides();
        for number in 0..105 {
            let cell = lattice.cell(number);
            assert_eq!(lattice.number(cell), number);
            assert_eq!(cell[0] as usize * dx + cell[1] as usize * dy + cell[2] as usize * dz, number);
            let middle = lattice.middle(cell).as_vec3();
            assert_eq!(lattice.range(&Aabb { min: middle, max: middle }), Some((cell, cell)));
        }
        let room = Vec3::splat(2.0 * PAD);
        let all = Aabb { min: bounds.min - room, max: bounds.max + room };
        assert!(lattice.aabb([0; 3], [6, 4, 2]).contains(&all));
        assert_eq!(lattice.range(&bounds).map(|(from, to)| (from[0], to[0])), Some((0, 6)));
        let beyond = Aabb { min: Vec3::splat(1.7), max: Vec3::splat(1.8) };
        assert_eq!(lattice.range(&beyond), None);
    }

    #[test]
    fn what_is_near_a_plane_is_on_both_sides_of_it() {
        let lattice = Lattice::around(&Aabb { min: Vec3::ZERO, max: Vec3::ONE }, [4; 3]);
        let plane = lattice.plane(1, 2) as f32;
        for (off, wanted) in [(-1.5, (1, 1)), (-0.9, (1, 2)), (0.0, (1, 2)), (0.9, (1, 2)), (1.5, (2, 2))] {
            let at = Vec3::new(0.1, plane + off * PAD, 0.1);
            let (from, to) = lattice.range(&Aabb { min: at, max: at }).unwrap();
            assert_eq!((from[1], to[1]), wanted, "{off} pads from the plane");
        }
    }

    #[test]
    fn what_is_occupied_is_counted() {
        let mut occupied = Occupied::default();
        let counts: Vec<u32> = (0..200).map(|i| u32::from(i % 3 == 0) * i).collect();
        occupied.push(&counts[..130]);
        occupied.push(&counts);
        let (mut seen, mut word) = (0, 0);
        for counts in [&counts[..130], &counts] {
            for (cell, &count) in counts.iter().enumerate() {
                assert_eq!(occupied.has(word, cell), count > 0);
                assert_eq!(occupied.rank(word, cell), seen);
                seen += u32::from(count > 0);
            }
            word = counts.len().div_ceil(64);
        }
        assert_eq!((occupied.count(), occupied.words()), (seen, 7));
        assert!(!occupied.has_any(3, 1, 3) && occupied.has_any(3, 1, 4) && occupied.has_any(3, 0, 200));
    }
}
