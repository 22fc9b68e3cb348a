//! Noise of one size.

use super::{Domain, Needs, Octaves, Pattern, TexturePoint};

/// Smooth random spots about a unit in size ([`super::perlin`]), which fade to their mean where they cannot be told
/// apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Where they lie.
    pub domain: Domain,
    /// Which of all noises.
    pub seed: u32,
}

impl Pattern for Noise {
    #[inline]
    fn amount(&self, point: &TexturePoint) -> f64 {
        let place = self.domain.place(point);
        let one = Octaves { count: 1, seed: self.seed, ..Octaves::default() };
        0.5 + 0.5 * one.sum(place.point, place.size())
    }

    fn needs(&self) -> Needs {
        self.domain.needs()
    }
}
