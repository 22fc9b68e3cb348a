//! Random numbers of choices in media whose number has no bound, such as null collisions along a ray.

use raywright_base::sampling::Sampler;

/// A sequence of random numbers without an end.
pub(crate) struct FurtherNumbers {
    sampler: Sampler,
    /// Count of numbers drawn.
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

/// Return the optical depth with transmittance 1 − u.
pub(crate) fn depth(u: f64) -> f64 {
    -(-u).ln_1p()
}
