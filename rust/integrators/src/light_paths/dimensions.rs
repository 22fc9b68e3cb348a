//! Sample dimensions of light paths.

use raywright_base::sampling::Sampler;
use raywright_scene::EmissionNumbers;

/// The dimensions of emission.
pub(crate) struct EmissionDimensions;

impl EmissionDimensions {
    /// Choice of the light; the pair that follows chooses the point on it.
    const LIGHT_CHOICE: u32 = 0;
    /// Point on the light.
    const PLACE: u32 = 1;
    /// Choice of the infinite light.
    const OUTSIDE: u32 = 2;
    /// Direction of emission.
    const DIRECTION: u32 = 3;
    /// Time.
    pub const TIME: u32 = 4;
    /// Hero wavelength of distance sampling in media.
    pub const HERO: u32 = 5;
    /// Wavelengths of the path; the first is the hero.
    pub const WAVES: u32 = Self::HERO;

    /// Draw the numbers of an emission sample.
    pub fn numbers(sampler: &mut Sampler) -> EmissionNumbers {
        EmissionNumbers {
            choice: sampler.one(Self::LIGHT_CHOICE),
            outside: sampler.one(Self::OUTSIDE),
            place: sampler.two(Self::PLACE),
            direction: sampler.two(Self::DIRECTION),
        }
    }
}

/// First dimension of the first surface.
const FIRST: u32 = 6;

/// The dimensions of a surface vertex. Choices have even dimensions, before the pair that depends on them: samplers
/// stratify the three together.
#[derive(Clone, Copy)]
pub(crate) struct Dimensions(u32);

impl Dimensions {
    const EACH: u32 = 6;

    /// Return the dimensions of the surface after `bounce` bounces.
    pub fn of(bounce: u32) -> Self {
        // Wrapping after 700 million bounces is harmless.
        Self(FIRST.wrapping_add(bounce.wrapping_mul(Self::EACH)))
    }

    /// Return the dimension of the choice of a lobe.
    pub fn scattering_choice(self) -> u32 {
        self.0
    }

    /// Return the dimension of the scattered direction.
    pub fn direction(self) -> u32 {
        self.0 + 1
    }

    /// Return the dimension of Russian roulette.
    pub fn roulette(self) -> u32 {
        self.0 + 2
    }

    /// Return the dimension of the point on the lens.
    pub fn lens(self) -> u32 {
        self.0 + 3
    }

    /// Return the dimension of stochastic alpha masks.
    pub fn mask(self) -> u32 {
        self.0 + 4
    }

    /// Return the dimension of the choice to store the vertex.
    pub fn keeping(self) -> u32 {
        self.0 + 5
    }
}
