//! An orthographic camera.

use super::connection::relative;
use super::window::{from_middle, to_pixels};
use super::{Body, Camera, CameraConnection, CameraError, CameraRay, Measured, Spread};
use raywright_base::math::{DVec3, Ray};

/// A camera with parallel rays. They start in the plane through its position, so it sees nothing behind that plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Orthographic {
    body: Body,
    /// Half the width and half the height of the view, in the scene's unit.
    half: [f64; 2],
}

impl Orthographic {
    /// Creates a camera whose view covers `scale` units of the scene along one of its picture's lengths. Pixels are
    /// square.
    ///
    /// # Errors
    /// If the scale is not positive and finite.
    pub fn new(body: Body, scale: f64, along: Measured) -> Result<Self, CameraError> {
        let size = body.size();
        let half = size.map(|pixels| 0.5 * (scale * (pixels / along.of(size))));
        if !(scale > 0.0 && half.iter().all(|h| *h > 0.0 && h.is_finite())) {
            return Err(CameraError::Scale);
        }
        Ok(Self { body, half })
    }
}

impl Camera for Orthographic {
    fn body(&self) -> &Body {
        &self.body
    }

    fn ray(&self, film: [f64; 2], _: [f64; 2], time: f64) -> CameraRay {
        let [x, y] = from_middle(film, self.body.size());
        let from = self.body.at(time);
        let origin = from.position + from.right * (self.half[0] * x) + from.up * (self.half[1] * y);
        CameraRay::seen(Ray { time: self.body.scene_time(time), ..Ray::new(origin, from.forward) })
    }

    fn connect(&self, point: DVec3, _: [f64; 2], time: f64) -> Option<CameraConnection> {
        let (from, size) = (self.body.at(time), self.body.size());
        let [right, up, along] = relative(&from, point);
        let [width, height] = self.half;
        let density = size[0] * size[1] / (4.0 * width * height);
        let film = to_pixels([right / width, up / height], size);
        // The origin is computed without the distance of the point, which would add rounding errors.
        let origin = from.position + from.right * right + from.up * up;
        CameraConnection { film, origin, density }.if_finite().filter(|_| along > 0.0)
    }

    fn spread(&self) -> Spread {
        Spread { angle: 0.0, width: 2.0 * self.half[1] / self.body.size()[1] }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Viewpoint;
    use super::*;

    fn body() -> Body {
        Body::new(Viewpoint::look_at(DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.0, 2.0, 0.0), DVec3::Y).unwrap(), 8, 4)
            .unwrap()
    }

    #[test]
    fn rays_are_parallel_and_pixels_apart() {
        let camera = Orthographic::new(body(), 2.0, Measured::Height).unwrap();
        let ray = |x, y| camera.ray([x, y], [0.5; 2], 0.0).ray;
        for (x, y, origin) in [
            (4.0, 2.0, DVec3::new(1.0, 2.0, 3.0)),
            (0.0, 0.0, DVec3::new(-1.0, 3.0, 3.0)),
            (8.0, 4.0, DVec3::new(3.0, 1.0, 3.0)),
            (5.0, 2.0, DVec3::new(1.5, 2.0, 3.0)),
        ] {
            assert_eq!((ray(x, y).origin, ray(x, y).direction), (origin, DVec3::NEG_Z));
        }
        assert_eq!(camera.spread(), Spread { angle: 0.0, width: 0.5 });
        let across = Orthographic::new(body(), 2.0, Measured::Width).unwrap();
        assert_eq!(across.ray([0.0, 0.0], [0.5; 2], 0.0).ray.origin, DVec3::new(0.0, 2.5, 3.0));
    }

    #[test]
    fn sees_something() {
        for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(Orthographic::new(body(), scale, Measured::Height), Err(CameraError::Scale));
        }
    }
}
