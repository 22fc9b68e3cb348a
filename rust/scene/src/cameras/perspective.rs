//! A pinhole camera.

use super::connection::relative;
use super::window::from_middle;
use super::{
    Body, Camera, CameraConnection, CameraError, CameraRay, CameraRayLanes, Measured, Spread, Viewpoint, Window,
};
use raywright_base::math::{DVec3, LANES, Ray, VectorLanes};
use raywright_base::sampling::Pairs;
use raywright_base::simd::{Level, loops};

/// A pinhole camera. It looks along its own −z with +y up; row 0 of its picture is at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Perspective {
    body: Body,
    window: Window,
    /// The film at distance 1 at shutter open: its center, half its width to the right, and half its height up.
    film: [DVec3; 3],
}

impl Perspective {
    /// Creates a camera with this window.
    pub fn new(body: Body, window: Window) -> Self {
        let film = window.axes(body.start());
        Self { body, window, film }
    }

    /// Creates a camera at `position` that looks at `target`, with `up` upwards in the picture, a vertical field of
    /// view in degrees, and square pixels.
    ///
    /// # Errors
    /// If an argument is invalid; see [`CameraError`].
    pub fn looking_at(
        position: DVec3,
        target: DVec3,
        up: DVec3,
        fov: f64,
        width: u32,
        height: u32,
    ) -> Result<Self, CameraError> {
        let body = Body::new(Viewpoint::look_at(position, target, up)?, width, height)?;
        let window = Window::of_view(fov, Measured::Height, body.size())?;
        Ok(Self::new(body, window))
    }

    /// Viewpoint at shutter open.
    pub fn viewpoint(&self) -> &Viewpoint {
        self.body.start()
    }

    /// The visible window.
    pub fn window(&self) -> &Window {
        &self.window
    }

    /// Ray of unit direction through a point of the film at shutter open: `x` in pixels from the left, `y` from the
    /// top.
    #[inline]
    pub fn ray_through(&self, x: f64, y: f64) -> Ray {
        self.ray_by(self.body.start().position, &self.film, [x, y], 0.0)
    }

    #[inline(always)]
    fn ray_by(&self, position: DVec3, window: &[DVec3; 3], film: [f64; 2], time: f64) -> Ray {
        let direction = towards(window, film, self.body.size());
        Ray { time: self.body.scene_time(time), ..Ray::new(position, direction) }
    }
}

/// Unit direction to a point of the film, which is at distance 1.
#[inline(always)]
fn towards([middle, right, up]: &[DVec3; 3], film: [f64; 2], size: [f64; 2]) -> DVec3 {
    let [x, y] = from_middle(film, size);
    (middle + right * x + up * y).normalize()
}

loops! {
    /// Unit directions to sixteen points of a film.
    fn all_towards(
        film: &[DVec3; 3],
        size: [f64; 2],
        points: &Pairs,
        directions: &mut VectorLanes,
    ) {
        for i in 0..LANES {
            directions.set(i, towards(film, [points[0][i], points[1][i]], size));
        }
    }
}

impl Camera for Perspective {
    fn body(&self) -> &Body {
        &self.body
    }

    fn ray(&self, film: [f64; 2], _: [f64; 2], time: f64) -> CameraRay {
        if !self.body.moves() {
            return CameraRay::seen(self.ray_by(self.body.start().position, &self.film, film, time));
        }
        let from = self.body.at(time);
        CameraRay::seen(self.ray_by(from.position, &self.window.axes(&from), film, time))
    }

    fn rays(&self, level: Level, film: &Pairs, lens: &Pairs, time: &[f64; LANES], rays: &mut CameraRayLanes) {
        if self.body.moves() {
            return rays.take_each(film, lens, time, |film, lens, time| self.ray(film, lens, time));
        }
        let CameraRayLanes { origin, direction, time: times, weight } = rays;
        all_towards(level, &self.film, self.body.size(), film, direction);
        for lane in 0..LANES {
            origin.set(lane, self.body.start().position);
            times[lane] = self.body.scene_time(time[lane]);
            weight[lane] = 1.0;
        }
    }

    fn connect(&self, point: DVec3, _: [f64; 2], time: f64) -> Option<CameraConnection> {
        let from = self.body.at(time);
        let (film, density) = self.window.connect(relative(&from, point), [0.0; 2], self.body.size())?;
        CameraConnection { film, origin: from.position, density }.if_finite()
    }

    fn spread(&self) -> Spread {
        Spread { angle: self.window.pixel_angle(self.body.size()), width: 0.0 }
    }

    fn as_perspective(&self) -> Option<&Perspective> {
        (!self.body.moves()).then_some(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn camera(position: DVec3, target: DVec3, fov: f64) -> Perspective {
        Perspective::looking_at(position, target, DVec3::Y, fov, 4, 2).unwrap()
    }

    #[test]
    fn looks_along_minus_z_with_row_0_on_top() {
        let camera = camera(DVec3::ZERO, DVec3::NEG_Z, 90.0);
        let close = |a: DVec3, b: DVec3| assert!((a - b.normalize()).length() < 1e-15, "{a} {b}");
        close(camera.ray_through(2.0, 1.0).direction, DVec3::NEG_Z);
        // 90 degrees over two rows: half the height is 1, half the width 2.
        close(camera.ray_through(0.0, 0.0).direction, DVec3::new(-2.0, 1.0, -1.0));
        close(camera.ray_through(4.0, 2.0).direction, DVec3::new(2.0, -1.0, -1.0));
        close(camera.ray_through(2.0, 0.0).direction, DVec3::new(0.0, 1.0, -1.0));
    }

    #[test]
    fn pixels_are_as_far_apart_as_it_says() {
        let far = Perspective::looking_at(DVec3::ZERO, DVec3::X, DVec3::Y, 2.0, 400, 300).unwrap();
        let [a, b] = [200.0, 201.0].map(|x| far.ray([x, 150.0], [0.5; 2], 0.0).ray.direction);
        assert!((a.angle_between(b) / far.spread().angle - 1.0).abs() < 1e-6);
    }

    proptest! {
        /// Independent formula of a pinhole at rest with square pixels about the center; rays must equal it bit for
        /// bit.
        #[test]
        fn rays_keep_their_bits(
            position in prop::array::uniform3(-9.0..9.0f64), target in prop::array::uniform3(-9.0..9.0f64),
            fov in 1.0..170.0f64, x in -1.0..5.0f64, y in -1.0..3.0f64, time in 0.0..1.0f64,
        ) {
            let [position, target] = [position, target].map(DVec3::from_array);
            let camera = camera(position, target, fov);
            let forward = 0.5 * target - 0.5 * position;
            let forward = (forward / forward.abs().max_element()).normalize();
            let right = forward.cross(DVec3::Y).normalize();
            let half_height = (0.5 * fov).to_radians().tan();
            let up = right.cross(forward) * half_height;
            let right = right * (half_height * 4.0 / 2.0);
            let direction = (forward + right * (2.0 * x / 4.0 - 1.0) + up * (1.0 - 2.0 * y / 2.0)).normalize();
            for ray in [camera.ray_through(x, y), camera.ray([x, y], [0.3, 0.9], time).ray] {
                prop_assert_eq!(ray.direction.to_array().map(f64::to_bits), direction.to_array().map(f64::to_bits));
                prop_assert_eq!(ray.origin, position);
            }
            prop_assert_eq!(camera.ray([x, y], [0.5; 2], time).ray.time, time);
        }
    }
}
