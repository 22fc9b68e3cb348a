//! A fisheye camera.

use super::connection::relative;
use super::{Body, Camera, CameraConnection, CameraError, CameraRay, Measured, Spread};
use raywright_base::math::{DVec3, Ray};

/// Radius in the picture as a function of the angle θ from the viewing direction (Miyamoto, "Fish Eye Lens", 1964;
/// names as in ISO and photography).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mapping {
    /// θ.
    #[default]
    Equidistant,
    /// 2 sin(θ/2). Areas are proportional to solid angles.
    Equisolid,
    /// 2 tan(θ/2). The mapping is conformal.
    Stereographic,
    /// sin θ: the hemisphere projected onto the film plane, so that areas are proportional to irradiance.
    Orthographic,
}

impl Mapping {
    /// Upper limit of the angle of view in degrees, and whether the limit itself is allowed.
    pub fn widest(self) -> (f64, bool) {
        match self {
            Self::Equidistant | Self::Equisolid => (360.0, true),
            Self::Stereographic => (360.0, false),
            Self::Orthographic => (180.0, true),
        }
    }

    /// Picture radius of an angle; near the center it equals the angle.
    fn radius(self, angle: f64) -> f64 {
        match self {
            Self::Equidistant => angle,
            Self::Equisolid => 2.0 * (0.5 * angle).sin(),
            Self::Stereographic => 2.0 * (0.5 * angle).tan(),
            Self::Orthographic => angle.sin(),
        }
    }

    /// Picture area per solid angle at an angle θ, relative to the center: r (dr/dθ) / sin θ.
    fn crowding(self, angle: f64) -> f64 {
        match self {
            Self::Equidistant => {
                let sine = angle.sin();
                if sine == 0.0 && angle < 1.0 { 1.0 } else { angle / sine }
            }
            Self::Equisolid => 1.0,
            Self::Stereographic => (0.5 * angle).cos().powi(-4),
            Self::Orthographic => angle.cos(),
        }
    }

    /// Sine and cosine of the angle at a radius.
    fn angle(self, radius: f64) -> (f64, f64) {
        match self {
            Self::Equidistant => radius.sin_cos(),
            Self::Equisolid => {
                // The sine of half the angle; double-angle formulas give the rest without an arc sine.
                let half = (0.5 * radius).min(1.0);
                (2.0 * half * ((1.0 - half) * (1.0 + half)).sqrt(), 1.0 - 2.0 * half * half)
            }
            Self::Stereographic => {
                let square = 0.25 * radius * radius;
                (radius / (1.0 + square), (1.0 - square) / (1.0 + square))
            }
            Self::Orthographic => {
                let sine = radius.min(1.0);
                (sine, ((1.0 - sine) * (1.0 + sine)).sqrt())
            }
        }
    }
}

/// A camera that maps its angle of view to a disk about the center of its picture. Pixels outside the disk are black.
#[derive(Clone, Debug, PartialEq)]
pub struct Fisheye {
    body: Body,
    mapping: Mapping,
    /// The mapping's radius at the edge of the disk.
    edge: f64,
    /// Factor from pixels to the mapping's radius.
    scale: f64,
}

impl Fisheye {
    /// Creates a fisheye camera with an angle of view in degrees. The disk's diameter is one of the picture's lengths:
    /// the smaller fits the disk into the picture, the diagonal puts it around the picture.
    ///
    /// # Errors
    /// If the angle is not positive, or wider than the mapping allows.
    pub fn new(body: Body, fov: f64, mapping: Mapping, along: Measured) -> Result<Self, CameraError> {
        let (widest, has_widest) = mapping.widest();
        if !(fov > 0.0 && (fov < widest || has_widest && fov == widest)) {
            return Err(CameraError::FieldOfView);
        }
        let edge = mapping.radius((0.5 * fov).to_radians());
        let scale = edge / (0.5 * along.of(body.size()));
        Ok(Self { body, mapping, edge, scale })
    }
}

impl Camera for Fisheye {
    fn body(&self) -> &Body {
        &self.body
    }

    fn ray(&self, [x, y]: [f64; 2], _: [f64; 2], time: f64) -> CameraRay {
        /// Bound on rounding, so that points on the disk's edge are visible.
        const ROOM: f64 = 1.0 + 4.0 * f64::EPSILON;
        let [width, height] = self.body.size();
        let [right, up] = [x - 0.5 * width, 0.5 * height - y];
        let pixels = right.hypot(up);
        let radius = self.scale * pixels;
        let (from, time) = (self.body.at(time), self.body.scene_time(time));
        // Comparison with NaN is false, so NaN is not visible.
        let is_seen = radius <= self.edge * ROOM;
        if !is_seen {
            return CameraRay::unseen(from.position, time);
        }
        let (sin, cos) = self.mapping.angle(radius);
        let aside = if pixels > 0.0 { sin / pixels } else { 0.0 };
        let direction = from.direction(right * aside, up * aside, cos).normalize();
        CameraRay::seen(Ray { time, ..Ray::new(from.position, direction) })
    }

    fn connect(&self, point: DVec3, _: [f64; 2], time: f64) -> Option<CameraConnection> {
        let (from, [width, height]) = (self.body.at(time), self.body.size());
        let [right, up, along] = relative(&from, point);
        let aside = right.hypot(up);
        let angle = aside.atan2(along);
        // The orthographic mapping sin θ folds back beyond a right angle; those directions are excluded.
        let radius = self.mapping.radius(angle);
        let is_seen = radius <= self.edge && (self.mapping != Mapping::Orthographic || along > 0.0);
        let pixels = if aside > 0.0 { radius / (self.scale * aside) } else { 0.0 };
        let film = [0.5 * width + right * pixels, 0.5 * height - up * pixels];
        let density = self.mapping.crowding(angle) / (self.scale * self.scale * (aside * aside + along * along));
        CameraConnection { film, origin: from.position, density }.if_finite().filter(|_| is_seen)
    }

    fn spread(&self) -> Spread {
        // Every mapping's radius is the angle itself near the center.
        Spread { angle: self.scale, width: 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Viewpoint;
    use super::*;

    const ALL: [Mapping; 4] = [Mapping::Equidistant, Mapping::Equisolid, Mapping::Stereographic, Mapping::Orthographic];

    fn fisheye(fov: f64, mapping: Mapping, along: Measured) -> Result<Fisheye, CameraError> {
        let viewpoint = Viewpoint::towards(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y).unwrap();
        Fisheye::new(Body::new(viewpoint, 160, 120).unwrap(), fov, mapping, along)
    }

    #[test]
    fn angles_are_those_of_the_mapping() {
        for (mapping, fov) in ALL.into_iter().flat_map(|m| [30.0, 120.0, 180.0, 300.0, 360.0].map(|fov| (m, fov))) {
            let Ok(camera) = fisheye(fov, mapping, Measured::Smaller) else { continue };
            let most = (0.5 * fov).to_radians();
            for i in 0..=48u32 {
                let theta = most * f64::from(i) / 48.0;
                let part = match mapping {
                    Mapping::Equidistant => theta / most,
                    Mapping::Equisolid => (0.5 * theta).sin() / (0.5 * most).sin(),
                    Mapping::Stereographic => (0.5 * theta).tan() / (0.5 * most).tan(),
                    Mapping::Orthographic => theta.sin() / most.sin(),
                };
                let (sin, cos) = (0.7 * f64::from(i)).sin_cos();
                let seen = camera.ray([80.0 + 60.0 * part * cos, 60.0 - 60.0 * part * sin], [0.5; 2], 0.0);
                let expected = DVec3::new(cos * theta.sin(), sin * theta.sin(), -theta.cos());
                // At the edge of some mappings dr/dθ is 0, and the angle is accurate only to the square root of a
                // rounding.
                let slow = matches!(mapping, Mapping::Equisolid if fov == 360.0)
                    || mapping == Mapping::Orthographic && fov == 180.0;
                let bound = if slow && i > 44 { 1e-7 } else { 2e-14 };
                assert!(
                    (seen.ray.direction - expected).length() < bound,
                    "{mapping:?} {fov} {i}: {}",
                    seen.ray.direction
                );
                assert!((seen.ray.direction.length() - 1.0).abs() < 1e-15 && seen.weight == 1.0);
            }
        }
    }

    #[test]
    fn beyond_the_circle_nothing_is_seen() {
        let camera = fisheye(180.0, Mapping::Equidistant, Measured::Smaller).unwrap();
        for (x, y) in [(19.9, 60.0), (0.0, 0.0), (80.0, 120.1), (f64::NAN, 0.0)] {
            let seen = camera.ray([x, y], [0.5; 2], 0.0);
            assert!(seen.weight == 0.0 && seen.ray.direction.is_nan());
        }
        // The disk around the picture has a diameter of 200.
        let around = fisheye(180.0, Mapping::Equidistant, Measured::Diagonal).unwrap();
        for (x, y) in [(0.0, 0.0), (160.0, 0.0), (0.0, 120.0), (160.0, 120.0)] {
            let seen = around.ray([x, y], [0.5; 2], 0.0);
            assert!(seen.weight == 1.0 && seen.ray.direction.z.abs() < 1e-14);
        }
    }

    #[test]
    fn angles_have_a_limit() {
        for mapping in ALL {
            let (widest, has_widest) = mapping.widest();
            assert_eq!(fisheye(widest, mapping, Measured::Height).is_ok(), has_widest);
            for fov in [0.0, -1.0, widest + 1.0, f64::NAN] {
                assert_eq!(fisheye(fov, mapping, Measured::Height), Err(CameraError::FieldOfView));
            }
        }
    }

    #[test]
    fn pixels_are_as_far_apart_as_it_says() {
        for mapping in ALL {
            let camera = fisheye(20.0, mapping, Measured::Width).unwrap();
            let [a, b] = [80.0, 81.0].map(|x| camera.ray([x, 60.0], [0.5; 2], 0.0).ray.direction);
            assert!((a.angle_between(b) / camera.spread().angle - 1.0).abs() < 1e-5, "{mapping:?}");
        }
    }
}
