//! Which random number is for what.

use raywright_base::sampling::CAMERA_DIMENSIONS;

/// The dimensions of a bounce. A choice stands at an even one, before the pair that follows from it, with which
/// samplers place it together; and what every surface asks for stands in the first four.
#[derive(Clone, Copy)]
pub(crate) struct Dimensions(u32);

impl Dimensions {
    const EACH: u32 = 6;

    /// What of a group's light is shared: the one of the camera's dimensions that it leaves unused.
    pub const SHARING: u32 = 2;

    /// Which wavelengths a path carries: the same, since such paths share nothing.
    pub const WAVES: u32 = Self::SHARING;

    /// Bounces that the branches of a split path have to themselves. Beyond, they draw the same numbers, of different
    /// meaning.
    const BRANCH: u32 = 1 << 9;

    /// Where the numbers of further light samples start.
    const MORE: u32 = 1 << 31;

    /// Those of a bounce of a branch of a path.
    #[inline]
    pub fn of(bounce: u32, branch: u32) -> Self {
        // Wrapping after 700 million bounces harms nobody.
        let place = bounce.wrapping_add(branch.wrapping_mul(Self::BRANCH));
        Self(CAMERA_DIMENSIONS.wrapping_add(place.wrapping_mul(Self::EACH)))
    }
    /// Which light the sample of this number asks; where on it, the dimension that follows says.
    #[inline]
    pub fn light_choice(self, number: u32) -> u32 {
        if number == 0 { self.0 } else { self.more(number) }
    }
    fn more(self, number: u32) -> u32 {
        Self::MORE | self.0.wrapping_mul(64).wrapping_add(2 * number)
    }
    /// Where a path goes on to.
    #[inline]
    pub fn direction(self) -> u32 {
        self.0 + 3
    }
    /// Whether it goes on.
    #[inline]
    pub fn roulette(self) -> u32 {
        self.0 + 4
    }
    /// Among several kinds of scattering, which.
    #[inline]
    pub fn scattering_choice(self) -> u32 {
        self.0 + 2
    }
    /// Which masks the ray passes.
    #[inline]
    pub fn mask(self) -> u32 {
        self.0 + 5
    }
}
