//! A thin lens with depth of field.

use super::connection::relative;
use super::window::from_middle;
use super::{Aperture, Body, Camera, CameraConnection, CameraError, CameraRay, Spread, Window};
use raywright_base::math::{DVec3, Ray};

/// A camera with a thin lens (Potmesil and Chakravarty, "A Lens and Aperture Camera Model for Synthetic Image
/// Generation", 1981). Points in a plane perpendicular to the view are in focus; others blur in proportion to the lens
/// radius.
///
/// The focal plane projects to the same film points as through a pinhole at the lens center.
#[derive(Clone, Debug, PartialEq)]
pub struct ThinLens {
    body: Body,
    window: Window,
    aperture: Aperture,
    /// Distance from the lens to the focal plane, along the view.
    focus: f64,
}

impl ThinLens {
    /// Creates a camera that is in focus at a distance along its view.
    ///
    /// # Errors
    /// If the distance is not positive and finite.
    pub fn new(body: Body, window: Window, aperture: Aperture, focus: f64) -> Result<Self, CameraError> {
        if !(focus > 0.0 && focus.is_finite()) {
            return Err(CameraError::Focus);
        }
        Ok(Self { body, window, aperture, focus })
    }
}

impl Camera for ThinLens {
    fn body(&self) -> &Body {
        &self.body
    }

    fn ray(&self, film: [f64; 2], lens: [f64; 2], time: f64) -> CameraRay {
        let from = self.body.at(time);
        let [x, y] = self.window.point(from_middle(film, self.body.size()));
        let [right, up] = self.aperture.point(lens);
        let origin = from.position + from.right * right + from.up * up;
        // Direction from the lens point to the point in focus, divided by the focus distance. The formula omits the
        // camera's position, so it stays accurate far from the origin.
        let direction = from.direction(x - right / self.focus, y - up / self.focus, 1.0).normalize();
        CameraRay::seen(Ray { time: self.body.scene_time(time), ..Ray::new(origin, direction) })
    }

    /// Each lens point is a pinhole with a shifted film.
    fn connect(&self, point: DVec3, lens: [f64; 2], time: f64) -> Option<CameraConnection> {
        let from = self.body.at(time);
        let [right, up] = self.aperture.point(lens);
        let [x, y, along] = relative(&from, point);
        let moved = [right / self.focus, up / self.focus];
        let (film, density) = self.window.connect([x - right, y - up, along], moved, self.body.size())?;
        let origin = from.position + from.right * right + from.up * up;
        CameraConnection { film, origin, density }.if_finite()
    }

    fn spread(&self) -> Spread {
        Spread { angle: self.window.pixel_angle(self.body.size()), width: 0.0 }
    }

    fn uses_lens(&self) -> bool {
        self.aperture.radius() > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Measured, Perspective, Viewpoint};
    use super::*;

    fn lens(radius: f64, blades: u32, focus: f64) -> (ThinLens, Perspective) {
        let viewpoint = Viewpoint::look_at(DVec3::new(1.0, 2.0, 3.0), DVec3::new(-1.0, 0.5, 0.0), DVec3::Y).unwrap();
        let body = Body::new(viewpoint, 40, 30).unwrap();
        let window = Window::of_view(50.0, Measured::Height, body.size()).unwrap();
        let aperture = Aperture::new(radius, blades, 0.2).unwrap();
        (ThinLens::new(body.clone(), window, aperture, focus).unwrap(), Perspective::new(body, window))
    }

    fn squares() -> impl Iterator<Item = [f64; 2]> {
        (0..100).map(|i| [(f64::from(i % 10) + 0.5) / 10.0, (f64::from(i / 10) + 0.5) / 10.0])
    }

    #[test]
    fn the_rays_of_a_point_meet_in_the_plane_in_focus() {
        for (blades, focus) in [(0, 4.0), (6, 0.3), (5, 70.0)] {
            let (camera, pinhole) = lens(0.1, blades, focus);
            let forward = pinhole.viewpoint().forward;
            for film in [[20.0, 15.0], [0.0, 0.0], [33.3, 28.1]] {
                let sharp = pinhole.ray_through(film[0], film[1]);
                let sharp = sharp.at(focus / sharp.direction.dot(forward));
                for u in squares() {
                    let ray = camera.ray(film, u, 0.0).ray;
                    let off = (ray.origin - pinhole.viewpoint().position).dot(forward);
                    assert!(off.abs() < 1e-15);
                    let met = ray.at(focus / ray.direction.dot(forward));
                    assert!((met - sharp).length() < 1e-12, "{met} {sharp}");
                }
            }
        }
    }

    #[test]
    fn the_circle_of_confusion_is_that_of_a_thin_lens() {
        // A lens of focal length f and diameter A, in focus at s, has the film at v = s f / (s − f). It images a point
        // at distance d as a circle of diameter c = A f |d − s| / (d (s − f)). At distance 1 the diameter is c / v = A
        // |d − s| / (d s).
        let (focus, focal) = (4.0, 0.1);
        let (camera, pinhole) = lens(0.25, 0, focus);
        let from = *pinhole.viewpoint();
        for distance in [1.0, 2.0, 3.9, 4.0, 5.0, 100.0] {
            let confusion = 0.5 * focal * f64::abs(distance - focus) / (distance * (focus - focal));
            let film = focus * focal / (focus - focal);
            // Rays from opposite edges of the lens: their separation at a distance equals the separation of their film
            // points for one point at that distance.
            let edge = 2f64.powi(-33);
            let [a, b] = [[edge, 0.5], [1.0 - edge, 0.5]].map(|u| {
                let ray = camera.ray([20.0, 15.0], u, 0.0).ray;
                ray.at(distance / ray.direction.dot(from.forward)) / distance
            });
            assert!(((a - b).length() - confusion / film).abs() < 1e-9, "{distance}");
        }
    }

    #[test]
    fn without_a_width_it_is_a_pinhole() {
        let (camera, pinhole) = lens(0.0, 0, 4.0);
        assert!(!camera.uses_lens());
        for film in [[3.0, 4.0], [20.0, 15.0]] {
            let (a, b) = (camera.ray(film, [0.9, 0.2], 0.0).ray, pinhole.ray_through(film[0], film[1]));
            assert!(a.origin == b.origin && (a.direction - b.direction).length() < 1e-15);
        }
        assert!(lens(0.1, 0, 4.0).0.uses_lens());
    }

    #[test]
    fn is_in_focus_before_it() {
        let (ThinLens { body, window, aperture, .. }, _) = lens(0.1, 0, 1.0);
        for focus in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(ThinLens::new(body.clone(), window, aperture, focus), Err(CameraError::Focus));
        }
    }
}
