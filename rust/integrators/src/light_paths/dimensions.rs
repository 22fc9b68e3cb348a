//! Which random number of a path from a light is for what.

use raywright_base::sampling::Sampler;
use raywright_scene::EmissionNumbers;

/// The dimensions of light that sets out.
pub(crate) struct EmissionDimensions;

impl EmissionDimensions {
    /// Which light the path starts at; where on it is told by the pair that follows.
    const LIGHT_CHOICE: u32 = 0;
    /// Where it starts.
    const PLACE: u32 = 1;
    /// Which of the lights outside.
    const OUTSIDE: u32 = 2;
    /// Where it goes.
    const DIRECTION: u32 = 3;
    /// When.
    pub const TIME: u32 = 4;
    /// Which wavelength decides how far it gets among media.
    pub const HERO: u32 = 5;
    /// Which wavelengths it carries, of which the first decides.
    pub const WAVES: u32 = Self::HERO;

    /// What it is drawn by.
    pub fn numbers(sampler: &mut Sampler) -> EmissionNumbers {
        EmissionNumbers {
            choice: sampler.one(Self::LIGHT_CHOICE),
            outside: sampler.one(Self::OUTSIDE),
            place: sampler.two(Self::PLACE),
            direction: sampler.two(Self::DIRECTION),
        }
    }
}

/// Those of the first surface.
const FIRST: u32 = 6;

/// The dimensions of a surface. A choice stands at an even one, before the pair that follows from it, with which
/// samplers place it together.
#[derive(Clone, Copy)]
pub(crate) struct Dimensions(u32);

impl Dimensions {
    const EACH: u32 = 6;

    /// Those of the surface after so many.
    pub fn of(bounce: u32) -> Self {
        // Wrapping after 700 million bounces harms nobody.
        Self(FIRST.wrapping_add(bounce.wrapping_mul(Self::EACH)))
    }

    /// Among several kinds of scattering, which.
    pub fn scattering_choice(self) -> u32 {
        self.0
    }

    /// Where the path goes on to.
    pub fn direction(self) -> u32 {
        self.0 + 1
    }

    /// Whether it goes on.
    pub fn roulette(self) -> u32 {
        self.0 + 2
    }

    /// From which point of the lens it is seen.
    pub fn lens(self) -> u32 {
        self.0 + 3
    }

    /// Which masks the ray passes.
    pub fn mask(self) -> u32 {
        self.0 + 4
    }

    /// Whether it is kept where the path has come to.
    pub fn keeping(self) -> u32 {
        self.0 + 5
    }
}
