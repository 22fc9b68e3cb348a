//! Random numbers of a path in media.

use crate::dimensions::Dimensions;
use raywright_base::sampling::Sampler;

/// The random numbers of one path. Fixed choices use sample dimensions. Choices whose number is unbounded, such as null
/// collisions along a ray, use a sequence of further numbers.
pub(crate) struct PathNumbers<'s> {
    sampler: &'s mut Sampler,
    /// An independent sequence, and the count of numbers drawn from it.
    more: Sampler,
    taken: u32,
    /// Dimensions of the path's current ray.
    pub ray: Dimensions,
}

impl<'s> PathNumbers<'s> {
    /// Make the numbers of a sample.
    pub fn new(sampler: &'s mut Sampler) -> Self {
        let more = sampler.paired();
        Self { sampler, more, taken: 0, ray: Dimensions::of(0, 0) }
    }

    /// Make the numbers of a sample whose paired sequence is used by another path.
    pub fn apart(sampler: &'s mut Sampler) -> Self {
        let more = sampler.apart();
        Self { sampler, more, taken: 0, ray: Dimensions::of(0, 0) }
    }

    /// Return a number in [0, 1) of a dimension.
    pub fn one(&mut self, dimension: u32) -> f64 {
        self.sampler.one(dimension)
    }

    /// Return a pair in (0, 1) of a dimension.
    pub fn two(&mut self, dimension: u32) -> [f64; 2] {
        self.sampler.two(dimension)
    }

    /// Return the next number in [0, 1) of the sequence.
    pub fn next(&mut self) -> f64 {
        self.taken = self.taken.wrapping_add(1);
        self.more.one(self.taken)
    }

    /// Choose one of three wavelengths by the next number.
    pub fn hero(&mut self) -> usize {
        ((self.next() * 3.0) as usize).min(2)
    }

    /// Sample an exponential optical depth by the next number.
    pub fn depth(&mut self) -> f64 {
        depth(self.next())
    }
}

/// Return the optical depth with transmittance 1 − u.
pub(crate) fn depth(u: f64) -> f64 {
    -(-u).ln_1p()
}
