//! The cone and the truncated cone.

use super::Revolution;
use super::revolution::ProfileCurve;
use raywright_base::math::DVec3;

impl Revolution {
    /// The cone about the segment from `base` to `tip`, which must differ. Neither radius is negative, and at most one
    /// is 0.
    ///
    /// The surface is a straight line rotated about the segment between the planes of its ends. It is closed by disks
    /// or open.
    ///
    /// u is the angle about the axis in turns. v is the arc length along the profile. The open profile runs from base
    /// to tip. The closed one runs from the center of the base cap over its rim and up the side to the center of the
    /// tip cap.
    pub fn cone(base: DVec3, tip: DVec3, radii: [f64; 2], capped: bool) -> Self {
        let profile = ProfileCurve::Straight { base: radii[0], tip: radii[1] };
        Self { base, tip, profile, capped }
    }
}
