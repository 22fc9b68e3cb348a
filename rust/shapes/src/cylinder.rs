//! The finite cylinder.

use super::Revolution;
use super::revolution::Profile;
use raywright_base::math::DVec3;

impl Revolution {
    /// The cylinder of a radius above 0 about the segment from `base` to `tip`, which differ.
    ///
    /// All points at one distance from a segment, between its ends' planes; closed by disks or open.
    ///
    /// Its coordinates are the angle about the axis, in turns, and the way along the profile: of an open one from the
    /// base to the tip, of a closed one from the middle of the base cap over its rim and up the side to the middle of
    /// the tip cap, by length.
    pub fn cylinder(base: DVec3, tip: DVec3, radius: f64, capped: bool) -> Self {
        let profile = Profile::Straight { base: radius, tip: radius };
        Self { base, tip, profile, capped }
    }
}
