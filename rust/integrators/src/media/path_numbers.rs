//! Random numbers of a path in media.

use crate::dimensions::Dimensions;
use raywright_base::sampling::Sampler;

/// The random numbers of one path. Fixed choices use sample dimensions. Choices whose number is unbounded, such as null
/// collisions along a ray, use a sequence of further numbers.
pub(crate) struct PathNumbers<'s> {
    sampler: &'s mut Sampler,
    pub more: &'s mut FurtherNumbers,
    /// Dimensions of the path's current ray.
    pub ray: Dimensions,
}

/// A sequence of random numbers without an end.
pub(crate) struct FurtherNumbers {
    sampler: Sampler,
    /// How many have been drawn.
    taken: u32,
}

impl FurtherNumbers {
    /// The sequence of a sampler, whose dimensions have no other use.
    pub fn new(sampler: Sampler) -> Self {
        Self { sampler, taken: 0 }
    }

    /// Return a sequence of its own for a branch of the path, of a number below 4096.
    pub fn branch(&self, number: u32) -> Self {
        Self { sampler: self.sampler.clone(), taken: self.taken.wrapping_add(number.wrapping_mul(1 << 20)) }
    }

    /// Return the next number in [0, 1).
    pub fn next(&mut self) -> f64 {
        self.taken = self.taken.wrapping_add(1);
        self.sampler.one(self.taken)
    }

    /// Choose one of three wavelengths.
    pub fn hero(&mut self) -> usize {
        ((self.next() * 3.0) as usize).min(2)
    }

    /// Sample an exponential optical depth.
    pub fn depth(&mut self) -> f64 {
        depth(self.next())
    }
}

impl<'s> PathNumbers<'s> {
    /// Make the numbers of a sample, with a sequence of further ones.
    pub fn new(sampler: &'s mut Sampler, more: &'s mut FurtherNumbers) -> Self {
        Self { sampler, more, ray: Dimensions::of(0, 0) }
    }

    /// Return a number in [0, 1) of a dimension.
    pub fn one(&mut self, dimension: u32) -> f64 {
        self.sampler.one(dimension)
    }

    /// Return a pair in (0, 1) of a dimension.
    pub fn two(&mut self, dimension: u32) -> [f64; 2] {
        self.sampler.two(dimension)
    }
}

/// Return the optical depth with transmittance 1 − u.
pub(crate) fn depth(u: f64) -> f64 {
    -(-u).ln_1p()
}
