//! A sparse grid of numbers.

use std::ops::Range;

/// `C` numbers at each point of a grid, in blocks of 8 points along an axis, or fewer in small grids. Blocks of zeros
/// take no memory.
///
/// A grid is built from parts ([`Building`]); equal numbers give equal blocks in any order.
#[derive(Clone, Debug, PartialEq)]
pub struct Blocks<const C: usize> {
    size: [usize; 3],
    /// Base-2 logarithm of a block's points along each axis.
    shift: [u32; 3],
    /// Number of blocks along each axis.
    count: [usize; 3],
    /// Storage index of each block, the last axis fastest; 0 is the block of zeros.
    places: Vec<u32>,
    numbers: Vec<[f32; C]>,
}

impl<const C: usize> Blocks<C> {
    /// Creates a grid from all numbers, the last axis fastest.
    ///
    /// # Errors
    /// As [`Building::new`] and [`Building::put`].
    pub fn new(size: [usize; 3], numbers: &[[f32; C]]) -> Result<Self, String> {
        let mut building = Building::new(size)?;
        building.put([0; 3], size, numbers)?;
        Ok(building.finish())
    }

    /// Number of points along each axis.
    pub fn size(&self) -> [usize; 3] {
        self.size
    }

    /// Points of a block along each axis.
    fn side(&self) -> [usize; 3] {
        self.shift.map(|shift| 1 << shift)
    }

    fn length(&self) -> usize {
        1 << (self.shift[0] + self.shift[1] + self.shift[2])
    }

    /// Storage index of a block.
    #[inline]
    fn place(&self, [x, y, z]: [usize; 3]) -> usize {
        self.places[(x * self.count[1] + y) * self.count[2] + z] as usize
    }

    /// The block of a point, and the point's offsets within it.
    #[inline]
    fn split(&self, [x, y, z]: [usize; 3]) -> [[usize; 3]; 2] {
        let [a, b, c] = self.shift;
        let within = |of: usize, shift: u32| of & ((1 << shift) - 1);
        [[x >> a, y >> b, z >> c], [within(x, a) << (b + c), within(y, b) << c, within(z, c)]]
    }

    /// Numbers at the corners of a cell, the last axis fastest; `None` if all are 0.
    #[inline]
    pub fn cell(&self, low: [usize; 3], high: [usize; 3]) -> Option<[[f32; C]; 8]> {
        // Written out, because calls of closures over arrays took most of the time.
        let ([from, [a, b, c]], [to, [d, e, f]]) = (self.split(low), self.split(high));
        if from == to {
            let place = self.place(from);
            let block = &self.numbers[place * self.length()..][..self.length()];
            let at = |x: usize, y: usize, z: usize| block[x + y + z];
            let all = || {
                [at(a, b, c), at(a, b, f), at(a, e, c), at(a, e, f), at(d, b, c), at(d, b, f), at(d, e, c), at(d, e, f)]
            };
            return (place != 0).then(all);
        }
        let (steps, mut found, mut any) = ([[a, d], [b, e], [c, f]], [[0.0; C]; 8], 0);
        for (i, found) in found.iter_mut().enumerate() {
            let [x, y, z] = [i >> 2 & 1, i >> 1 & 1, i & 1];
            let place = self.place([[from, to][x][0], [from, to][y][1], [from, to][z][2]]);
            any |= place;
            *found = self.numbers[place * self.length() + steps[0][x] + steps[1][y] + steps[2][z]];
        }
        (any != 0).then_some(found)
    }

    /// Minimum and maximum of each of the `C` numbers in a part.
    pub fn range(&self, part: [Range<usize>; 3]) -> [[f32; C]; 2] {
        let [mut least, mut most] = [[f32::INFINITY; C], [0.0f32; C]];
        self.parts(&part, |place, rows| {
            if place == 0 {
                least = [0.0; C];
                return;
            }
            for row in rows {
                let start = place * self.length();
                for numbers in &self.numbers[start + row.start..start + row.end] {
                    for (i, &number) in numbers.iter().enumerate() {
                        (least[i], most[i]) = (least[i].min(number), most[i].max(number));
                    }
                }
            }
        });
        [least, most]
    }

    /// Iterates over the blocks of a part, with their storage index and the rows within the part.
    fn parts(&self, part: &[Range<usize>; 3], mut each: impl FnMut(usize, &mut dyn Iterator<Item = Range<usize>>)) {
        let side = self.side();
        let blocks = |axis: usize| part[axis].start / side[axis]..part[axis].end.div_ceil(side[axis]);
        for x in blocks(0) {
            for y in blocks(1) {
                for z in blocks(2) {
                    let block = [x, y, z];
                    let span = |axis: usize| {
                        let start = block[axis] * side[axis];
                        part[axis].start.max(start) - start..part[axis].end.min(start + side[axis]) - start
                    };
                    let spans = [span(0), span(1), span(2)];
                    let mut rows = spans[0].clone().flat_map(|i| {
                        let columns = spans[2].clone();
                        spans[1].clone().map(move |j| {
                            let row = (i * side[1] + j) * side[2];
                            row + columns.start..row + columns.end
                        })
                    });
                    each(self.place(block), &mut rows);
                }
            }
        }
    }

    /// Numbers of a part, the last axis fastest.
    pub fn part(&self, part: [Range<usize>; 3]) -> Vec<[f32; C]> {
        let mut found = Vec::with_capacity(part.iter().map(ExactSizeIterator::len).product());
        let [x, y, z] = part;
        for i in x {
            for j in y.clone() {
                for k in z.clone() {
                    let point = [i, j, k];
                    let [block, [x, y, z]] = self.split(point);
                    found.push(self.numbers[self.place(block) * self.length() + x + y + z]);
                }
            }
        }
        found
    }

    /// Lower corner of each stored block, and the corner one past its last point.
    pub fn kept(&self) -> impl Iterator<Item = [[usize; 3]; 2]> + '_ {
        let [_, y, z] = self.count;
        let side = self.side();
        let kept = self.places.iter().enumerate().filter(|&(_, &place)| place != 0);
        kept.map(move |(block, _)| {
            let block = [block / z / y, block / z % y, block % z];
            let low = [0, 1, 2].map(|axis| block[axis] * side[axis]);
            [low, [0, 1, 2].map(|axis| (low[axis] + side[axis]).min(self.size[axis]))]
        })
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.numbers.as_slice()) + size_of_val(self.places.as_slice())
    }
}

/// A grid under construction, initially zero.
#[derive(Clone, Debug)]
pub struct Building<const C: usize>(Blocks<C>);

impl<const C: usize> Building<C> {
    /// Creates a grid with this number of points along each axis.
    ///
    /// # Errors
    /// A short reason if a size is zero, or the grid is too large to count.
    pub fn new(size: [usize; 3]) -> Result<Self, String> {
        let told = || format!("{} x {} x {} numbers", size[0], size[1], size[2]);
        if size.contains(&0) {
            return Err(format!("has {}, expected at least one", told()));
        }
        let shift = size.map(|n| n.next_power_of_two().trailing_zeros().min(3));
        let count = [0, 1, 2].map(|axis| size[axis].div_ceil(1 << shift[axis]));
        let blocks = count[0].checked_mul(count[1]).and_then(|n| n.checked_mul(count[2]));
        let blocks = blocks
            .filter(|&n| n < 1 << 31)
            .ok_or_else(|| format!("has {}, expected fewer than 2^31 blocks of 8 x 8 x 8", told()))?;
        let zeros = vec![[0.0; C]; 1 << (shift[0] + shift[1] + shift[2])];
        Ok(Self(Blocks { size, shift, count, places: vec![0; blocks], numbers: zeros }))
    }

    /// Sets the numbers of a part, given by its first point and its size, the last axis fastest.
    ///
    /// # Errors
    /// A short reason if the part reaches beyond the grid, the number of values differs from its size, or a value is
    /// negative or not finite.
    pub fn put(&mut self, from: [usize; 3], size: [usize; 3], numbers: &[[f32; C]]) -> Result<(), String> {
        let all = size[0].checked_mul(size[1]).and_then(|n| n.checked_mul(size[2]));
        if all != Some(numbers.len()) {
            return Err(format!("has {} numbers, not {} x {} x {}", numbers.len(), size[0], size[1], size[2]));
        }
        if (0..3).any(|axis| from[axis].checked_add(size[axis]).is_none_or(|end| end > self.0.size[axis])) {
            return Err(format!("has a part of {size:?} at {from:?}, beyond its {:?} points", self.0.size));
        }
        let is_bad = |values: &[f32; C]| values.iter().any(|v| !(0.0..=f32::MAX).contains(v));
        if let Some(bad) = numbers.iter().position(is_bad) {
            let within = [bad / size[2] / size[1], bad / size[2] % size[1], bad % size[2]];
            let place = [0, 1, 2].map(|axis| from[axis] + within[axis]);
            let value = numbers[bad].iter().find(|v| !(0.0..=f32::MAX).contains(*v)).copied().unwrap_or(f32::NAN);
            return Err(format!("must be finite and at least 0, got {value} at {place:?}"));
        }
        let side = self.0.side();
        let blocks = |axis: usize| from[axis] / side[axis]..(from[axis] + size[axis]).div_ceil(side[axis]);
        for x in blocks(0) {
            for y in blocks(1) {
                for z in blocks(2) {
                    self.put_into([x, y, z], from, size, numbers);
                }
            }
        }
        Ok(())
    }

    /// Sets the overlap of a block with a part.
    fn put_into(&mut self, block: [usize; 3], from: [usize; 3], size: [usize; 3], numbers: &[[f32; C]]) {
        let side = self.0.side();
        let span = |axis: usize| {
            let start = block[axis] * side[axis];
            from[axis].max(start)..(from[axis] + size[axis]).min(start + side[axis])
        };
        let [x, y, z] = [span(0), span(1), span(2)];
        let row = |i: usize, j: usize| {
            let start = ((i - from[0]) * size[1] + (j - from[1])) * size[2] + z.start - from[2];
            &numbers[start..start + z.len()]
        };
        let index = (block[0] * self.0.count[1] + block[1]) * self.0.count[2] + block[2];
        if self.0.places[index] == 0 {
            let is_empty = |(i, j)| row(i, j).iter().flatten().all(|&number| number == 0.0);
            if x.clone().flat_map(|i| y.clone().map(move |j| (i, j))).all(is_empty) {
                return;
            }
            let length = self.0.length();
            self.0.places[index] = (self.0.numbers.len() / length) as u32;
            self.0.numbers.resize(self.0.numbers.len() + length, [0.0; C]);
        }
        let start = self.0.places[index] as usize * self.0.length();
        for i in x {
            for j in y.clone() {
                let [_, [a, b, c]] = self.0.split([i, j, z.start]);
                let source = &numbers[((i - from[0]) * size[1] + (j - from[1])) * size[2] + z.start - from[2]..];
                self.0.numbers[start + a + b + c..][..z.len()].copy_from_slice(&source[..z.len()]);
            }
        }
    }

    /// Finishes the grid and removes blocks that are all zero.
    pub fn finish(self) -> Blocks<C> {
        let Self(mut blocks) = self;
        let length = blocks.length();
        let is_empty = |block: &[[f32; C]]| block.iter().flatten().all(|&number| number == 0.0);
        let kept: Vec<u32> = blocks.places.iter().copied().filter(|&place| place != 0).collect();
        let is_plain = kept.is_sorted() && !blocks.numbers.chunks_exact(length).skip(1).any(is_empty);
        if !is_plain {
            let mut numbers = vec![[0.0; C]; length];
            for place in blocks.places.iter_mut().filter(|place| **place != 0) {
                let block = &blocks.numbers[*place as usize * length..][..length];
                *place = if is_empty(block) { 0 } else { (numbers.len() / length) as u32 };
                if *place != 0 {
                    numbers.extend_from_slice(block);
                }
            }
            blocks.numbers = numbers;
        }
        blocks.numbers.shrink_to_fit();
        blocks
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::Sampler;

    const SIZE: [usize; 3] = [19, 9, 30];

    /// Numbers with many empty blocks.
    fn numbers() -> Vec<[f32; 1]> {
        let point = |i: usize| [i / 30 / 9, i / 30 % 9, i % 30];
        let number = |i: usize| {
            let [x, y, z] = point(i);
            if x < 8 && y < 8 || z / 8 == 1 { 0.0 } else { Sampler::new(3, 0, i as u32).one(0) as f32 }
        };
        (0..19 * 9 * 30).map(|i| [number(i)]).collect()
    }

    #[test]
    fn numbers_are_where_they_were_put_and_zeros_take_nothing() {
        let all = numbers();
        let blocks = Blocks::new(SIZE, &all).unwrap();
        assert_eq!(blocks.part([0..19, 0..9, 0..30]), all);
        // 3 x 2 x 4 blocks: one layer of four is empty, and one column at small x and y.
        assert_eq!(blocks.kept().count(), 5 * 3);
        assert_eq!(blocks.bytes(), 4 * (512 * 16 + 24));
        let at = |[x, y, z]: [usize; 3]| all[(x * 9 + y) * 30 + z];
        for low in [[0, 0, 0], [7, 7, 7], [3, 7, 15], [15, 2, 23], [18, 8, 29], [9, 4, 20]] {
            let high = [0, 1, 2].map(|axis: usize| (low[axis] + 1).min(SIZE[axis] - 1));
            let corner = |i: usize| [[low, high][i >> 2][0], [low, high][i >> 1 & 1][1], [low, high][i & 1][2]];
            let truth: [[f32; 1]; 8] = std::array::from_fn(|i| at(corner(i)));
            assert_eq!(blocks.cell(low, high).unwrap_or([[0.0]; 8]), truth);
        }
        assert_eq!(blocks.cell([1; 3], [2; 3]), None);
        let most = all.iter().map(|[number]| *number).fold(0.0, f32::max);
        assert_eq!(blocks.range([0..19, 0..9, 0..30]), [[0.0], [most]]);
        let part = blocks.part([7..12, 6..9, 13..20]).into_iter().map(|[number]| number).fold(0.0, f32::max);
        assert_eq!(blocks.range([7..12, 6..9, 13..20])[1], [part]);
        assert_eq!(blocks.range([0..8, 0..8, 0..30]), [[0.0]; 2]);
    }

    #[test]
    fn the_same_numbers_make_the_same_blocks_in_any_order() {
        let all = numbers();
        let whole = Blocks::new(SIZE, &all).unwrap();
        let mut building = Building::new(SIZE).unwrap();
        // Parts that overwrite earlier ones, partly with zeros.
        building.put([0, 0, 0], [8, 8, 8], &[[2.0]; 512]).unwrap();
        for x in (0..19).rev() {
            for z in [10..30, 0..10] {
                building.put([x, 0, z.start], [1, 9, z.len()], &whole.part([x..x + 1, 0..9, z])).unwrap();
            }
        }
        assert_eq!(building.finish(), whole);
    }

    #[test]
    fn a_few_points_along_an_axis_make_small_blocks() {
        let blocks = Blocks::new([400, 1, 3], &vec![[1.0, 2.0, 3.0]; 1200]).unwrap();
        assert_eq!(blocks.cell([399, 0, 1], [399, 0, 2]).unwrap(), [[1.0, 2.0, 3.0]; 8]);
        assert_eq!(blocks.bytes(), 51 * 8 * 4 * 12 + 50 * 4);
    }

    #[test]
    fn refuses_what_is_no_amount_and_what_lies_beyond() {
        for bad in [-1.0, f32::NAN, f32::INFINITY] {
            let why = Blocks::new([1, 2, 2], &[[1.0], [0.0], [1.0], [bad]]).unwrap_err();
            assert!(why.contains("[0, 1, 1]"), "{why}");
        }
        assert!(Blocks::<1>::new([0, 1, 1], &[]).is_err());
        assert!(Blocks::new([2, 1, 1], &[[1.0]]).is_err());
        assert!(Building::<1>::new([1 << 40, 1 << 40, 8]).is_err());
        let mut building = Building::new([4, 4, 4]).unwrap();
        assert!(building.put([3, 0, 0], [2, 1, 1], &[[1.0]; 2]).is_err());
        assert!(building.put([usize::MAX, 0, 0], [2, 1, 1], &[[1.0]; 2]).is_err());
    }
}
