//! Connections from a point of the scene to the film.

use super::Viewpoint;
use raywright_base::math::DVec3;

/// A connection from a point of the scene to the film, for light tracing and bidirectional methods.
///
/// It inverts [`Camera::ray`](super::Camera::ray), which maps the film to the scene. Importance (Veach, "Robust Monte
/// Carlo Methods for Light Transport Simulation", 1997, 8.1) is measured in pixels, because a pixel is a mean over the
/// film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraConnection {
    /// Film position of the point in pixels. It may lie outside the picture, within reach of a pixel's filter.
    pub film: [f64; 2],
    /// Origin of the ray that meets the point.
    pub origin: DVec3,
    /// Pixels per area at the point, perpendicular to the ray, in one over the scene's unit squared. It equals the
    /// importance of a pixel over the squared distance.
    pub density: f64,
}

impl CameraConnection {
    /// Returns the connection if its numbers are finite and its density positive. A point too near or too far overflows
    /// and is not connected.
    pub(super) fn if_finite(self) -> Option<Self> {
        let numbers = [self.film[0], self.film[1], self.density];
        (numbers.iter().all(|n| n.is_finite()) && self.density > 0.0).then_some(self)
    }
}

/// Coordinates of a point relative to a viewpoint: right, up and forward.
pub(super) fn relative(from: &Viewpoint, point: DVec3) -> [f64; 3] {
    let way = point - from.position;
    [way.dot(from.right), way.dot(from.up), way.dot(from.forward)]
}

#[cfg(test)]
mod tests {
    use super::super::{Aperture, Body, Camera, Fisheye, Mapping, Measured, Orthographic, Panorama, Perspective};
    use super::super::{ThinLens, Window};
    use super::*;
    use raywright_base::sampling::Sampler;

    /// Every kind of camera, at rest and moving, with each of its mappings.
    fn cameras() -> Vec<Box<dyn Camera>> {
        let start = Viewpoint::look_at(DVec3::new(1.0, 2.0, 3.0), DVec3::new(-1.0, 0.5, 0.0), DVec3::Y).unwrap();
        let end = Viewpoint::look_at(DVec3::new(1.5, 2.0, 2.0), DVec3::new(0.0, 0.5, 0.3), DVec3::Y).unwrap();
        let still = Body::new(start, 40, 30).unwrap().with_shutter([0.25, 0.75]).unwrap();
        let mut all: Vec<Box<dyn Camera>> = Vec::new();
        for body in [still.clone(), still.moved_to(end)] {
            let window = Window::of_view(50.0, Measured::Height, body.size()).unwrap();
            let skewed = Window::of_matrix([-33.0, 41.0], [12.0, 17.0], 3.0, body.size()).unwrap();
            for window in [window, skewed] {
                all.push(Box::new(Perspective::new(body.clone(), window)));
                let aperture = Aperture::new(0.1, 6, 0.2).unwrap();
                all.push(Box::new(ThinLens::new(body.clone(), window, aperture, 2.5).unwrap()));
            }
            all.push(Box::new(Orthographic::new(body.clone(), 3.0, Measured::Width).unwrap()));
            all.push(Box::new(Panorama::new(body.clone())));
            for mapping in [Mapping::Equidistant, Mapping::Equisolid, Mapping::Stereographic, Mapping::Orthographic] {
                all.push(Box::new(Fisheye::new(body.clone(), 170.0, mapping, Measured::Diagonal).unwrap()));
            }
        }
        all
    }

    /// A point on a ray connects back to the film point of that ray. Its density is one over the perpendicular area of
    /// the rays through a unit square of film, by finite differences.
    #[test]
    fn connections_are_the_inverse_of_rays() {
        for (number, camera) in (0u32..).zip(cameras()) {
            let mut seen = 0;
            for sample in 0..200 {
                let mut sampler = Sampler::new(3, number, sample);
                let ([u, v], lens, [time, far]) = (sampler.two(0), sampler.two(1), sampler.two(2));
                let film = [40.0 * u, 30.0 * v];
                let drawn = camera.ray(film, lens, time);
                if drawn.weight == 0.0 {
                    continue;
                }
                let (ray, far) = (drawn.ray, 0.1 + 10.0 * far);
                let point = ray.at(far);
                let found = camera.connect(point, lens, time).expect("it is seen");
                let off = (found.film[0] - film[0]).hypot(found.film[1] - film[1]);
                assert!(off < 1e-9, "{camera:?}: {:?} for {film:?}", found.film);
                assert!((found.origin - ray.origin).length() < 1e-12, "{camera:?}");
                let step = 1e-4;
                let across = |by: [f64; 2]| {
                    let other = camera.ray([film[0] + by[0], film[1] + by[1]], lens, time).ray;
                    let way = (point - other.origin).dot(ray.direction) / other.direction.dot(ray.direction);
                    other.at(way)
                };
                let side = |by: [f64; 2]| (across(by) - across(by.map(|x| -x))) / (2.0 * step);
                let area = side([step, 0.0]).cross(side([0.0, step])).length();
                if area.is_nan() {
                    continue;
                }
                assert!((found.density * area - 1.0).abs() < 1e-5, "{camera:?}: {} {area}", found.density);
                seen += 1;
            }
            assert!(seen > 100, "{camera:?}: {seen}");
        }
    }

    #[test]
    fn what_lies_behind_is_not_seen() {
        for camera in cameras().iter().filter(|camera| !camera.body().moves()) {
            let from = *camera.body().start();
            let behind = camera.connect(from.position - from.forward, [0.5; 2], 0.0);
            let sees_all = camera.ray([0.0, 15.0], [0.5; 2], 0.0).ray.direction.dot(from.forward) < -0.99;
            assert_eq!(behind.is_some(), sees_all, "{camera:?}");
            assert_eq!(camera.connect(DVec3::NAN, [0.5; 2], 0.0), None);
            assert_eq!(camera.connect(from.position, [0.5; 2], 0.0).filter(|c| c.density > 1e30), None);
        }
    }
}
