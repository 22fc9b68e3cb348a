//! Paths that go on as several: each branch but the first becomes a sample of its own, which adds to that of its path.

/// The samples of a batch whose paths may split. The first so many are the camera's; each branch that a path splits off
/// is one more.
#[derive(Default)]
pub(super) struct Branches {
    /// The camera's sample that each adds to, and its number among the branches of that.
    of: Vec<u32>,
    number: Vec<u32>,
}

/// More samples than any batch has. Shared radiance has numbers after those of all samples; paths that split share
/// none.
pub(super) const MOST: u32 = 1 << 30;

impl Branches {
    /// Begins with so many samples of the camera.
    pub fn begin(&mut self, samples: usize) {
        self.of.clear();
        self.of.extend(0..samples as u32);
        self.number.clear();
        self.number.resize(samples, 0);
    }

    /// Return the number of samples.
    pub fn len(&self) -> usize {
        self.of.len()
    }

    /// The number of a sample among its branches.
    #[inline]
    pub fn number(&self, sample: u32) -> u32 {
        self.number[sample as usize]
    }

    /// The number of the path of a sample among its branches from now on.
    pub fn renumber(&mut self, sample: u32, number: u32) {
        self.number[sample as usize] = number;
    }

    /// Splits another branch off the path of a sample, and returns the sample of that.
    pub fn split(&mut self, sample: u32, number: u32) -> u32 {
        self.of.push(self.of[sample as usize]);
        self.number.push(number);
        self.of.len() as u32 - 1
    }

    /// Adds what samples have found to those of the camera.
    pub fn gather<T: Copy + std::ops::AddAssign>(&self, found: &[T], to: &mut [T]) {
        for (&found, &of) in found.iter().zip(&self.of) {
            to[of as usize] += found;
        }
    }
}
