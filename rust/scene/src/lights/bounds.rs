//! Spatial and directional bounds of lights, the nodes of the light tree.

use raywright_base::math::{DVec3, Frame};
use std::f64::consts::{FRAC_PI_2, PI};

/// A bounding box of lights, a cone that bounds their normals, and the emission angle around those (Conty Estevez and
/// Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", 2018).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightBounds {
    /// Lower corner of the box.
    pub min: DVec3,
    /// Upper corner of the box.
    pub max: DVec3,
    /// Unit axis of the normal cone.
    pub axis: DVec3,
    /// Cosine of the half angle of the normal cone; −1 if it contains all directions.
    pub cos_cone: f64,
    /// Cosine of the greatest angle to the normal at which a light emits, at most a right angle.
    pub cos_reach: f64,
    /// Sum of the greatest intensities, W·sr⁻¹.
    pub intensity: f64,
}

/// Margin for the roundings of cones in radians: directions on the rim must be inside.
const ROOM: f64 = 1e-6;

impl LightBounds {
    /// Bounds of a point light that emits in all directions.
    pub fn everywhere(position: DVec3, intensity: f64) -> Self {
        let (min, max) = (position, position);
        Self { min, max, axis: DVec3::Z, cos_cone: -1.0, cos_reach: 0.0, intensity }
    }

    /// Bounds of a point light that emits, roughly uniformly, within an angle of an axis in radians.
    pub fn within(position: DVec3, axis: DVec3, angle: f64, intensity: f64) -> Self {
        let (min, max) = (position, position);
        Self { min, max, axis, cos_cone: (angle + ROOM).cos(), cos_reach: (1e-3f64).cos(), intensity }
    }

    /// Bounds of a surface in a box, with one normal or all, whose intensity falls with the cosine.
    pub fn surface([min, max]: [DVec3; 2], normal: Option<DVec3>, intensity: f64) -> Self {
        let (axis, cos_cone) = normal.map_or((DVec3::Z, -1.0), |n| (n, 1.0));
        Self { min, max, axis, cos_cone, cos_reach: 0.0, intensity }
    }

    /// The center of the box.
    #[inline(always)]
    pub fn centre(&self) -> DVec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// The union of two bounds.
    pub fn union(&self, other: &Self) -> Self {
        let (axis, cos_cone) = cone_of(self, other);
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            axis,
            cos_cone,
            cos_reach: self.cos_reach.min(other.cos_reach),
            intensity: self.intensity + other.intensity,
        }
    }

    /// Surface area orientation heuristic without constant factors: intensity times area times solid angle of emission
    /// (Conty Estevez and Kulla, 2018, their equation 1). The area is that of the sphere around the box, because
    /// collinear lights have a box without area.
    pub fn cost(&self) -> f64 {
        let cone = self.cos_cone.clamp(-1.0, 1.0).acos();
        let (sin, cos) = cone.sin_cos();
        let reach = (cone + self.cos_reach.clamp(-1.0, 1.0).acos()).min(PI);
        let directions = 2.0 * PI * (1.0 - cos)
            + FRAC_PI_2 * (2.0 * reach * sin - (cone - 2.0 * reach).cos() - 2.0 * cone * sin + cos);
        self.intensity * directions * (self.max - self.min).length_squared()
    }
}

/// The smallest cone around two, with a small margin.
fn cone_of(a: &LightBounds, b: &LightBounds) -> (DVec3, f64) {
    let angles = [a, b].map(|bounds| bounds.cos_cone.clamp(-1.0, 1.0).acos());
    let (wide, narrow, [wider, narrower]) =
        if angles[0] >= angles[1] { (a, b, angles) } else { (b, a, [angles[1], angles[0]]) };
    // By both sine and cosine, so that small angles keep their digits.
    let between = wide.axis.cross(narrow.axis).length().atan2(wide.axis.dot(narrow.axis));
    if between + narrower <= wider {
        return (wide.axis, wide.cos_cone);
    }
    let half = 0.5 * (wider + between + narrower) + ROOM;
    if half >= PI {
        return (wide.axis, -1.0);
    }
    let across = narrow.axis - wide.axis * narrow.axis.dot(wide.axis);
    // For opposite axes any perpendicular axis of rotation will do.
    let across = across.try_normalize().unwrap_or_else(|| Frame::new(wide.axis).tangent);
    let (sin, cos) = (half - ROOM - wider).sin_cos();
    ((wide.axis * cos + across * sin).normalize(), half.cos())
}
