//! Single-scale noise.

use super::{Domain, Needs, Octaves, Pattern, TexturePoint};

/// Smooth random features of about unit size ([`super::perlin`]), which fade to their mean below the footprint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Domain.
    pub domain: Domain,
    /// Random seed.
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
