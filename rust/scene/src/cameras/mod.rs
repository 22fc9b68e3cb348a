//! Where a picture is seen from: cameras, one file each.

mod aperture;
mod body;
mod connection;
mod error;
mod fisheye;
mod lanes;
mod orthographic;
mod panorama;
mod perspective;
mod thin_lens;
mod viewpoint;
mod window;

pub use aperture::Aperture;
pub use body::Body;
pub use connection::CameraConnection;
pub use error::CameraError;
pub use fisheye::{Fisheye, Mapping};
pub use lanes::CameraRayLanes;
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

/// What turns points of a picture into rays.
///
/// A point of the film is told in pixels, x from the left and y from the top, so that the centre of the first pixel is
/// at (0.5, 0.5).
pub trait Camera: Debug + Send + Sync {
    /// The picture's size, and where the camera is over time.
    fn body(&self) -> &Body;

    /// The ray through a point of the film and a point of the lens, each coordinate in (0, 1) and its centre at
    /// (0.5, 0.5), at a time from 0 as the shutter opens to 1 as it closes.
    fn ray(&self, film: [f64; 2], lens: [f64; 2], time: f64) -> CameraRay;

    /// What [`Camera::ray`] gives for a point of the film, a point of the lens and a time of each lane.
    fn rays(&self, _: Level, film: &Pairs, lens: &Pairs, time: &[f64; LANES], rays: &mut CameraRayLanes) {
        rays.take_each(film, lens, time, |film, lens, time| self.ray(film, lens, time));
    }

    /// How the camera sees a point of the scene from a point of the lens, at a time as [`Camera::ray`] has it; `None`
    /// where it does not, whatever lies between.
    fn connect(&self, point: DVec3, lens: [f64; 2], time: f64) -> Option<CameraConnection>;

    /// What a pixel covers.
    fn spread(&self) -> Spread;

    /// Whether the point of the lens matters.
    fn uses_lens(&self) -> bool {
        false
    }

    /// Whether the camera itself moves, so that the time matters in a scene where nothing does.
    fn uses_time(&self) -> bool {
        self.body().moves()
    }

    /// The camera as a pinhole that stays where it is, whose pictures can be rasterised; none if it is no such one.
    fn as_perspective(&self) -> Option<&Perspective> {
        None
    }

    /// Pixels in a row.
    fn width(&self) -> u32 {
        self.body().width()
    }

    /// Rows.
    fn height(&self) -> u32 {
        self.body().height()
    }
}

/// A ray of a camera, and how much it counts.
#[derive(Clone, Copy, Debug)]
pub struct CameraRay {
    /// Of unit direction, at a time of the scene. Where the weight is 0 it is none: its direction is NaN, and it hits
    /// nothing.
    pub ray: Ray,
    /// What the radiance along it is multiplied by; 0 where the camera sees nothing.
    pub weight: f64,
}

impl CameraRay {
    /// A ray that counts in full.
    #[inline(always)]
    fn seen(ray: Ray) -> Self {
        Self { ray, weight: 1.0 }
    }

    /// No ray, of a point of the film that shows nothing.
    fn unseen(origin: DVec3, time: f64) -> Self {
        Self { ray: Ray { time, ..Ray::new(origin, DVec3::NAN) }, weight: 0.0 }
    }
}

/// How far apart the rays of neighbouring pixels are: at a distance t, by `width + angle * t`. Where that differs over
/// the picture, it is that of its middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Between directions, in radians.
    pub angle: f64,
    /// At the camera, in the scene's unit.
    pub width: f64,
}

/// The unit vector along `v`, of whatever length; `None` for zero.
fn unit(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    (largest > 0.0).then(|| (v / largest).normalize())
}
