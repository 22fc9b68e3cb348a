//! Numbers on a regular grid over the unit cube, and what lies between.

use crate::math::DVec3;

/// Where in the cells of a grid its numbers stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum At {
    /// At their corners: the outermost on the faces of the cube.
    Corners,
    /// In the middle of each: within half a cell of a face, what is there is that of the cell.
    Centres,
}

/// Numbers on a regular grid over the unit cube, `C` of them at a point, interpolated linearly along each axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Values<const C: usize> {
    size: [usize; 3],
    at: At,
    /// The last axis runs fastest.
    numbers: Vec<[f32; C]>,
}

impl<const C: usize> Values<C> {
    /// Of so many along each axis.
    ///
    /// # Errors
    /// If there are none, or another number of them, or if one is negative or not finite: which, in a few words.
    pub fn new(size: [usize; 3], at: At, numbers: Vec<[f32; C]>) -> Result<Self, String> {
        if size.contains(&0) {
            return Err(format!("has {} x {} x {} numbers, expected at least one", size[0], size[1], size[2]));
        }
        if size[0].checked_mul(size[1]).and_then(|n| n.checked_mul(size[2])) != Some(numbers.len()) {
            return Err(format!("has {} numbers, not {} x {} x {}", numbers.len(), size[0], size[1], size[2]));
        }
        let is_bad = |values: &[f32; C]| values.iter().any(|v| !(0.0..=f32::MAX).contains(v));
        if let Some(bad) = numbers.iter().position(is_bad) {
            let place = [bad / size[2] / size[1], bad / size[2] % size[1], bad % size[2]];
            let value = numbers[bad].iter().find(|v| !(0.0..=f32::MAX).contains(*v)).copied().unwrap_or(f32::NAN);
            return Err(format!("must be finite and not negative, is {value} at {place:?}"));
        }
        Ok(Self { size, at, numbers })
    }

    /// How many numbers there are along each axis.
    pub fn size(&self) -> [usize; 3] {
        self.size
    }

    /// A coordinate of the unit cube in steps of the grid along an axis, from the first number on.
    #[inline]
    fn steps(&self, axis: usize, u: f64) -> f64 {
        let last = (self.size[axis] - 1) as f64;
        match self.at {
            At::Corners => (u * last).clamp(0.0, last),
            At::Centres => (u * self.size[axis] as f64 - 0.5).clamp(0.0, last),
        }
    }

    /// What is at a point of the unit cube, of which one outside counts as the nearest within.
    #[inline]
    pub fn value(&self, point: DVec3) -> [f64; C] {
        let mut low = [0; 3];
        let mut high = [0; 3];
        let mut part = [0.0; 3];
        for axis in 0..3 {
            let steps = self.steps(axis, point[axis]);
            low[axis] = steps as usize;
            high[axis] = (low[axis] + 1).min(self.size[axis] - 1);
            part[axis] = steps - low[axis] as f64;
        }
        let number = |x: usize, y: usize, z: usize| &self.numbers[(x * self.size[1] + y) * self.size[2] + z];
        let mut sum = [0.0; C];
        for (x, wx) in [(low[0], 1.0 - part[0]), (high[0], part[0])] {
            for (y, wy) in [(low[1], 1.0 - part[1]), (high[1], part[1])] {
                for (z, wz) in [(low[2], 1.0 - part[2]), (high[2], part[2])] {
                    let weight = wx * wy * wz;
                    for (sum, &value) in sum.iter_mut().zip(number(x, y, z)) {
                        *sum += weight * f64::from(value);
                    }
                }
            }
        }
        sum
    }

    /// The greatest number of any kind in each of so many equal blocks of the unit cube, the last axis fastest.
    pub fn greatest(&self, blocks: [usize; 3]) -> Vec<f32> {
        let mut greatest = Vec::with_capacity(blocks.iter().product());
        // Which numbers count in a part of the cube: those within, and the next on either side.
        let counting = |axis: usize, block: usize| {
            let [from, to] = [block, block + 1].map(|b| self.steps(axis, b as f64 / blocks[axis] as f64));
            // What rounding may have moved to the other side of a number counts too.
            let last = (self.size[axis] - 1) as f64;
            let [from, to] = [from * (1.0 - 1e-12), (to * (1.0 + 1e-12)).min(last)];
            from.floor() as usize..to.ceil() as usize + 1
        };
        for x in 0..blocks[0] {
            for y in 0..blocks[1] {
                for z in 0..blocks[2] {
                    let mut most = 0.0f32;
                    for i in counting(0, x) {
                        for j in counting(1, y) {
                            let row = (i * self.size[1] + j) * self.size[2];
                            let span = counting(2, z);
                            let some = &self.numbers[row + span.start..row + span.end];
                            most = some.iter().flatten().fold(most, |most, &value| most.max(value));
                        }
                    }
                    greatest.push(most);
                }
            }
        }
        greatest
    }

    /// The memory held.
    pub fn bytes(&self) -> usize {
        size_of_val(self.numbers.as_slice())
    }
}
