//! Spectral MIS weights of paths.

use raywright_optics::Rgb;

/// Path weights for three wavelengths, all relative to the density of the hero's path sampling. So the hero's own
/// density is 1, and the mean of the three is at least a third.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Weights {
    /// Throughput from the vertex to the start of the path (pbrt-v4: beta).
    pub carried: Rgb,
    /// Density of the path for each wavelength as the hero (r_u).
    pub drawn: Rgb,
    /// The same with light sampling at the last scattering event instead of the segment since (r_l).
    pub asked: Rgb,
}

impl Weights {
    /// Weights at the start of a path.
    pub const START: Self = Self { carried: Rgb::ONE, drawn: Rgb::ONE, asked: Rgb::ONE };

    /// Return the weight of light at this vertex.
    #[inline]
    pub fn throughput(&self) -> Rgb {
        self.carried / self.drawn.mean()
    }

    /// Multiply all three.
    #[inline]
    pub fn times(&mut self, carried: Rgb, drawn: Rgb, asked: Rgb) {
        self.carried *= carried;
        self.drawn *= drawn;
        self.asked *= asked;
    }
}
