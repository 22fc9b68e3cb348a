//! The finite cylinder.

use super::Revolution;
use super::revolution::ProfileCurve;
use raywright_base::math::DVec3;

impl Revolution {
    /// The cylinder with a radius above 0 about the segment from `base` to `tip`, which must differ.
    ///
    /// The surface has constant distance from the segment between the planes of its ends. It is closed by disks or
    /// open.
    ///
    /// u is the angle about the axis in turns. v is the arc length along the profile. The open profile runs from base
    /// to tip. The closed one runs from the center of the base cap over its rim and up the side to the center of the
    /// tip cap.
    pub fn cylinder(base: DVec3, tip: DVec3, radius: f64, capped: bool) -> Self {
        let profile = ProfileCurve::Straight { base: radius, tip: radius };
        Self { base, tip, profile, capped }
    }
}
