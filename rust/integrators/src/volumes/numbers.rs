//! Random numbers of a path through media.

use crate::dimensions::Dimensions;
use raywright_base::sampling::Sampler;

/// The numbers of one path. Those of which every stage has its own come by their dimensions; of which a stage may need
/// any number, such as the places where a ray meets nothing in the end, one after the other.
pub(crate) struct Numbers<'s> {
    sampler: &'s mut Sampler,
    /// Numbers that have nothing to do with these, and how many were taken.
    more: Sampler,
    taken: u32,
    /// Which ray of the path it is about.
    pub ray: Dimensions,
}

impl<'s> Numbers<'s> {
    /// Those of a sample.
    pub fn new(sampler: &'s mut Sampler) -> Self {
        let more = sampler.paired();
        Self { sampler, more, taken: 0, ray: Dimensions::of(0, 0) }
    }

    /// The same where another path has the sample's paired numbers.
    pub fn apart(sampler: &'s mut Sampler) -> Self {
        let more = sampler.apart();
        Self { sampler, more, taken: 0, ray: Dimensions::of(0, 0) }
    }

    /// A number in [0, 1) of a dimension.
    pub fn one(&mut self, dimension: u32) -> f64 {
        self.sampler.one(dimension)
    }

    /// A pair in (0, 1) of a dimension.
    pub fn two(&mut self, dimension: u32) -> [f64; 2] {
        self.sampler.two(dimension)
    }

    /// The next of those without a name, in [0, 1).
    pub fn next(&mut self) -> f64 {
        self.taken = self.taken.wrapping_add(1);
        self.more.one(self.taken)
    }

    /// Which of three wavelengths decides, by the next number.
    pub fn hero(&mut self) -> usize {
        ((self.next() * 3.0) as usize).min(2)
    }

    /// An optical depth that a ray gets through, as often as light does: by the next number.
    pub fn depth(&mut self) -> f64 {
        depth(self.next())
    }
}

/// The optical depth that a share of 1 − u of light gets through.
pub(crate) fn depth(u: f64) -> f64 {
    -(-u).ln_1p()
}
