//! Random numbers of a path.

use crate::dimensions::Dimensions;
use crate::media::path_numbers::FurtherNumbers;
use raywright_base::sampling::Sampler;

/// The random numbers of one path. Fixed choices use sample dimensions. Choices whose number is unbounded, such as null
/// collisions along a ray, use a sequence of further numbers.
pub(crate) struct PathNumbers<'s> {
    sampler: &'s mut Sampler,
    pub more: &'s mut FurtherNumbers,
    /// Dimensions of the path's current ray.
    pub ray: Dimensions,
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
