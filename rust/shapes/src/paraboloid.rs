//! The paraboloid of revolution.

use super::Revolution;
use super::revolution::Profile;
use raywright_base::math::DVec3;

impl Revolution {
    /// The paraboloid from `apex` to the plane of the rim, whose middle is `tip`, which differ, and whose radius is
    /// above 0.
    ///
    /// What a parabola draws when it is turned about its axis, from the apex to a rim; closed by a disk there or open.
    /// With a radius r at a height h it is z = h ρ² / r², and its focus lies r² / 4h above the apex.
    ///
    /// Its coordinates are the angle about the axis, in turns, and the distance from it, as a share of the rim's; of a
    /// closed one that is the first half, and the second goes on from the rim to the middle of the cap.
    pub fn paraboloid(apex: DVec3, tip: DVec3, radius: f64, capped: bool) -> Self {
        let profile = Profile::Parabola { tip: radius };
        Self { base: apex, tip, profile, capped }
    }
}
