//! Cameras, one file each.

mod aperture;
mod body;
mod camera_lanes;
mod connection;
mod error;
mod fisheye;
mod orthographic;
mod panorama;
mod perspective;
mod thin_lens;
mod viewpoint;
mod window;

pub use aperture::Aperture;
pub use body::Body;
pub use camera_lanes::CameraRayLanes;
pub use connection::CameraConnection;
pub use error::CameraError;
pub use fisheye::{Fisheye, Mapping};
pub use orthographic::Orthographic;
pub use panorama::Panorama;
pub use perspective::Perspective;
pub use thin_lens::ThinLens;
pub use viewpoint::Viewpoint;
pub use window::{Measured, Window};

use raywright_base::math::{DVec3, LANES, Ray};
use raywright_base::sampling::Pairs;
use raywright_base::simd::Level;
use std::fmt::Debug;

/// A camera maps points of the film to rays.
///
/// Film positions are in pixels, x from the left and y from the top; the center of the first pixel is (0.5, 0.5).
pub trait Camera: Debug + Send + Sync {
    /// Picture size, viewpoint and shutter.
    fn body(&self) -> &Body;

    /// Generates the ray through a point of the film and a point of the lens, at a time from 0 (shutter open) to 1
    /// (shutter close). Lens coordinates are in (0, 1); the lens center is (0.5, 0.5).
    fn ray(&self, film: [f64; 2], lens: [f64; 2], time: f64) -> CameraRay;

    /// Generates rays of sixteen lanes; each lane's result equals that of [`Camera::ray`].
    fn rays(&self, _: Level, film: &Pairs, lens: &Pairs, time: &[f64; LANES], rays: &mut CameraRayLanes) {
        rays.take_each(film, lens, time, |film, lens, time| self.ray(film, lens, time));
    }

    /// Connects a point of the scene to the film, through a point of the lens and at a time of the shutter. Returns
    /// `None` if the point is outside the view. Visibility is not tested.
    fn connect(&self, point: DVec3, lens: [f64; 2], time: f64) -> Option<CameraConnection>;

    /// Footprint of a pixel.
    fn spread(&self) -> Spread;

    /// Returns whether rays depend on the point of the lens.
    fn uses_lens(&self) -> bool {
        false
    }

    /// Returns whether the camera itself moves, so that the time matters even in a scene at rest.
    fn uses_time(&self) -> bool {
        self.body().moves()
    }

    /// Returns the camera as a pinhole at rest, whose primary hits can be rasterized; `None` for other cameras.
    fn as_perspective(&self) -> Option<&Perspective> {
        None
    }

    /// Number of columns.
    fn width(&self) -> u32 {
        self.body().width()
    }

    /// Number of rows.
    fn height(&self) -> u32 {
        self.body().height()
    }
}

/// A camera ray and its weight.
#[derive(Clone, Copy, Debug)]
pub struct CameraRay {
    /// The ray, with unit direction and a scene time. If the weight is 0, its direction is NaN and it hits nothing.
    pub ray: Ray,
    /// Factor on the radiance along the ray; 0 outside the view.
    pub weight: f64,
}

impl CameraRay {
    /// A ray of weight 1.
    #[inline(always)]
    fn seen(ray: Ray) -> Self {
        Self { ray, weight: 1.0 }
    }

    /// An empty ray, for a film point outside the view.
    fn unseen(origin: DVec3, time: f64) -> Self {
        Self { ray: Ray { time, ..Ray::new(origin, DVec3::NAN) }, weight: 0.0 }
    }
}

/// Distance between the rays of adjacent pixels: `width + angle * t` at a distance t. If it varies over the picture,
/// this is its value at the center.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Angle between adjacent rays, in radians.
    pub angle: f64,
    /// Distance at the camera, in the scene's unit.
    pub width: f64,
}

/// Normalizes a vector without overflow or underflow; returns `None` for zero.
fn unit(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    (largest > 0.0).then(|| (v / largest).normalize())
}
