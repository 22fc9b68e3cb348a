//! The paraboloid of revolution.

use super::Revolution;
use super::revolution::ProfileCurve;
use raywright_base::math::DVec3;

impl Revolution {
    /// The paraboloid from `apex` to the rim plane through `tip`, which must differ, with a rim radius above 0.
    ///
    /// The surface is a parabola rotated about its axis from the apex to the rim. It is closed by a disk there or open.
    /// With radius r at height h it is z = h ρ² / r², and its focus lies r² / 4h above the apex.
    ///
    /// u is the angle about the axis in turns. v is the distance from the axis as a fraction of the rim's radius. If
    /// closed, that is the first half of v, and the second half runs from the rim to the center of the cap.
    pub fn paraboloid(apex: DVec3, tip: DVec3, radius: f64, capped: bool) -> Self {
        let profile = ProfileCurve::Parabola { tip: radius };
        Self { base: apex, tip, profile, capped }
    }
}
