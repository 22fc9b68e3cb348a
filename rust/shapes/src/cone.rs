//! The cone and the truncated cone.

use super::Revolution;
use super::revolution::Profile;
use raywright_base::math::DVec3;

impl Revolution {
    /// The cone about the segment from `base` to `tip`, which differ, with a radius at either end: one may be 0, and
    /// neither is less.
    ///
    /// What a straight line draws when it is turned about a segment, from the plane of one end to that of the other;
    /// closed by disks or open.
    ///
    /// Its coordinates are the angle about the axis, in turns, and the way along the profile: of an open one from the
    /// base to the tip, of a closed one from the middle of the base cap over its rim and up the side to the middle of
    /// the tip cap, by length.
    pub fn cone(base: DVec3, tip: DVec3, radii: [f64; 2], capped: bool) -> Self {
        let profile = Profile::Straight { base: radii[0], tip: radii[1] };
        Self { base, tip, profile, capped }
    }
}
