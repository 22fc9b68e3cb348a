//! An equirectangular camera of the whole sphere.

use super::connection::relative;
use super::{Body, Camera, CameraConnection, CameraRay, Spread};
use raywright_base::math::{DVec3, Ray};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A camera of the whole sphere with an equirectangular mapping: columns are longitudes, rows are latitudes. The
/// viewing direction is at the center of the picture and up is the top row. Right is a quarter of the width to the
/// right of the center; both side edges show the direction backwards.
///
/// For a camera that looks along −z with +y up, the picture at fractions (u, v) of its width from the left and of its
/// height from the top has direction (sin φ sin θ, cos θ, −cos φ sin θ) with φ = 2π (u − ½) and θ = π v.
#[derive(Clone, Debug, PartialEq)]
pub struct Panorama {
    body: Body,
}

impl Panorama {
    /// Creates a camera; its viewpoint determines the center of the picture.
    pub fn new(body: Body) -> Self {
        Self { body }
    }
}

impl Camera for Panorama {
    fn body(&self) -> &Body {
        &self.body
    }

    fn ray(&self, [x, y]: [f64; 2], _: [f64; 2], time: f64) -> CameraRay {
        let [width, height] = self.body.size();
        let from = self.body.at(time);
        let (sin, cos) = (TAU * (x / width - 0.5)).sin_cos();
        // The angle is measured from the horizon, not from the pole, so that the middle row is level to the last bit.
        let (up, level) = (FRAC_PI_2 - PI * y / height).sin_cos();
        let direction: DVec3 = from.direction(sin * level, up, cos * level);
        CameraRay::seen(Ray { time: self.body.scene_time(time), ..Ray::new(from.position, direction.normalize()) })
    }

    fn connect(&self, point: DVec3, _: [f64; 2], time: f64) -> Option<CameraConnection> {
        let (from, [width, height]) = (self.body.at(time), self.body.size());
        let [right, up, along] = relative(&from, point);
        let level = right.hypot(along);
        let film = [width * (0.5 + right.atan2(along) / TAU), height * (0.5 - up.atan2(level) / PI)];
        // Picture area per solid angle grows by one over the sine of the colatitude, relative to the horizon.
        let distance = level.hypot(up);
        let density = width * height / (TAU * PI * level * distance);
        CameraConnection { film, origin: from.position, density }.if_finite()
    }

    fn spread(&self) -> Spread {
        let [width, height] = self.body.size();
        Spread { angle: (TAU / width * (PI / height)).sqrt(), width: 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Viewpoint;
    use super::*;

    fn panorama(direction: DVec3) -> Panorama {
        Panorama::new(Body::new(Viewpoint::towards(DVec3::ONE, direction, DVec3::Y).unwrap(), 400, 200).unwrap())
    }

    #[test]
    fn directions_are_where_the_convention_says() {
        let camera = panorama(DVec3::NEG_Z);
        for (u, v, expected) in [
            (0.5, 0.5, DVec3::NEG_Z),
            (0.75, 0.5, DVec3::X),
            (0.25, 0.5, DVec3::NEG_X),
            (0.0, 0.5, DVec3::Z),
            (1.0, 0.5, DVec3::Z),
            (0.3, 0.0, DVec3::Y),
            (0.9, 1.0, DVec3::NEG_Y),
            (0.625, 0.25, DVec3::new(0.5, 0.5f64.sqrt(), -0.5)),
        ] {
            let ray = camera.ray([400.0 * u, 200.0 * v], [0.5; 2], 0.0).ray;
            assert!((ray.direction - expected).length() < 1e-15, "{u} {v}: {}", ray.direction);
            assert_eq!(ray.origin, DVec3::ONE);
        }
        for i in 0..400 {
            let (u, v) = (f64::from(i) / 400.0, f64::from(i * 7 % 200) / 200.0);
            let ((sin, cos), theta) = ((TAU * (u - 0.5)).sin_cos(), PI * v);
            let expected = DVec3::new(sin * theta.sin(), theta.cos(), -cos * theta.sin());
            let ray = camera.ray([400.0 * u, 200.0 * v], [0.5; 2], 0.0).ray;
            assert!((ray.direction - expected).length() < 1e-15);
        }
    }

    #[test]
    fn the_middle_is_where_it_looks_and_right_is_right() {
        let camera = panorama(DVec3::X);
        let direction = |u: f64, v: f64| camera.ray([400.0 * u, 200.0 * v], [0.5; 2], 0.0).ray.direction;
        assert!((direction(0.5, 0.5) - DVec3::X).length() < 1e-15);
        assert!((direction(0.75, 0.5) - DVec3::Z).length() < 1e-15);
    }

    #[test]
    fn pixels_are_as_far_apart_as_it_says() {
        let camera = panorama(DVec3::X);
        let [a, b] = [200.0, 201.0].map(|x| camera.ray([x, 100.0], [0.5; 2], 0.0).ray.direction);
        assert!((a.angle_between(b) / camera.spread().angle - 1.0).abs() < 1e-9);
    }
}
