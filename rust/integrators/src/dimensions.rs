//! Sample dimensions of paths.

use raywright_base::sampling::{CAMERA_DIMENSIONS, Sampler};
use raywright_scene::EmissionNumbers;

/// The dimensions of emission, the first vertex of a light path. Its bounces are numbered from 1 on, and [`Dimensions`]
/// of bounce 0 are unused.
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
    /// Wavelengths of the path. Without them, the color that samples distances in media.
    pub const WAVES: u32 = 5;

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

/// The dimensions of a bounce. Choices have even dimensions, before the pair that depends on them: samplers stratify
/// the three together. The first four are those that every surface uses.
#[derive(Clone, Copy)]
pub(crate) struct Dimensions(u32);

impl Dimensions {
    const EACH: u32 = 6;

    /// Choice of shared light in a group: an unused dimension of the camera.
    pub const SHARING: u32 = 2;

    /// Wavelengths of a path. The dimension may coincide: paths that share have common wavelengths.
    pub const WAVES: u32 = Self::SHARING;

    /// Number of bounces with separate dimensions for the branches of a split path. Later bounces use the same numbers
    /// for different choices.
    const BRANCH: u32 = 1 << 9;

    /// First dimension of further light samples.
    const MORE: u32 = 1 << 31;

    /// Return the dimensions of a bounce of a branch.
    #[inline]
    pub fn of(bounce: u32, branch: u32) -> Self {
        // Wrapping after 700 million bounces is harmless.
        let place = bounce.wrapping_add(branch.wrapping_mul(Self::BRANCH));
        Self(CAMERA_DIMENSIONS.wrapping_add(place.wrapping_mul(Self::EACH)))
    }
    /// Return the dimension of the light choice of a sample; the next dimension is the point on the light.
    #[inline]
    pub fn light_choice(self, number: u32) -> u32 {
        if number == 0 { self.0 } else { self.more(number) }
    }
    /// Return the dimension of the choice to store a vertex of a light path, which chooses no light.
    pub fn storing(self) -> u32 {
        self.0
    }
    /// Return the dimension of the point on the lens that a vertex of a light path is connected to.
    pub fn lens(self) -> u32 {
        self.0 + 1
    }
    fn more(self, number: u32) -> u32 {
        Self::MORE | self.0.wrapping_mul(64).wrapping_add(2 * number)
    }
    /// Return the dimension of Russian roulette.
    #[inline]
    pub fn roulette(self) -> u32 {
        self.0 + 4
    }
    /// Return the dimension of the choice of a lobe.
    #[inline]
    pub fn scattering_choice(self) -> u32 {
        self.0 + 2
    }
    /// Return the dimension of stochastic alpha masks.
    #[inline]
    pub fn mask(self) -> u32 {
        self.0 + 5
    }
}
