//! The parts common to all cameras: picture size, viewpoint and shutter.

use super::viewpoint::CameraMotion;
use super::{CameraError, Viewpoint};

/// Picture size, a viewpoint that may move, and a shutter.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    width: u32,
    height: u32,
    start: Viewpoint,
    way: Option<CameraMotion>,
    open: f64,
    /// Exposure time.
    duration: f64,
}

impl Body {
    /// Creates a camera body at rest. Its shutter is open from 0 to 1 of the scene's time.
    ///
    /// # Errors
    /// If there is no pixel, or 2³¹ or more.
    pub fn new(viewpoint: Viewpoint, width: u32, height: u32) -> Result<Self, CameraError> {
        if width == 0 || height == 0 || u64::from(width) * u64::from(height) >= 1 << 31 {
            return Err(CameraError::Size);
        }
        Ok(Self { width, height, start: viewpoint, way: None, open: 0.0, duration: 1.0 })
    }

    /// Sets the scene times at which the shutter opens and closes, both from 0 to 1.
    ///
    /// # Errors
    /// If it closes before it opens, or a time is outside [0, 1].
    pub fn with_shutter(self, [open, close]: [f64; 2]) -> Result<Self, CameraError> {
        if !(0.0 <= open && open <= close && close <= 1.0) {
            return Err(CameraError::Shutter);
        }
        Ok(Self { open, duration: close - open, ..self })
    }

    /// Sets the viewpoint at shutter close; the camera moves there from its first viewpoint.
    pub fn moved_to(self, end: Viewpoint) -> Self {
        Self { way: (end != self.start).then(|| CameraMotion::new(self.start, end)), ..self }
    }

    /// Number of columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Number of rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Width and height in pixels.
    #[inline(always)]
    pub fn size(&self) -> [f64; 2] {
        [f64::from(self.width), f64::from(self.height)]
    }

    /// Returns whether the camera moves.
    pub fn moves(&self) -> bool {
        self.way.is_some()
    }

    /// Viewpoint at shutter open.
    pub fn start(&self) -> &Viewpoint {
        &self.start
    }

    /// Viewpoint at a time from 0 (shutter open) to 1 (shutter close).
    #[inline]
    pub fn at(&self, time: f64) -> Viewpoint {
        match &self.way {
            None => self.start,
            Some(way) => way.at(time),
        }
    }

    /// Scene time at a time of the shutter.
    #[inline(always)]
    pub fn scene_time(&self, time: f64) -> f64 {
        self.open + self.duration * time
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::math::DVec3;

    fn body() -> Body {
        Body::new(Viewpoint::look_at(DVec3::ZERO, DVec3::Z, DVec3::Y).unwrap(), 4, 2).unwrap()
    }

    #[test]
    fn the_shutter_is_open_within_the_scenes_time() {
        assert_eq!([0.0, 0.3, 1.0].map(|t| body().scene_time(t)), [0.0, 0.3, 1.0]);
        let short = body().with_shutter([0.5, 0.75]).unwrap();
        assert_eq!([0.0, 0.5, 1.0].map(|t| short.scene_time(t)), [0.5, 0.625, 0.75]);
        assert_eq!(body().with_shutter([0.25, 0.25]).unwrap().scene_time(0.7), 0.25);
        for shutter in [[-0.1, 0.5], [0.0, 1.1], [0.6, 0.5], [f64::NAN, 1.0], [0.0, f64::NAN]] {
            assert_eq!(body().with_shutter(shutter), Err(CameraError::Shutter));
        }
    }

    #[test]
    fn moves_if_it_ends_elsewhere() {
        let start = *body().start();
        assert!(!body().moved_to(start).moves());
        let end = Viewpoint { position: DVec3::ONE, ..start };
        let moving = body().moved_to(end);
        assert!(moving.moves());
        assert_eq!((moving.at(0.0), moving.at(1.0)), (start, end));
        assert_eq!(moving.at(0.25).position, DVec3::splat(0.25));
    }

    #[test]
    fn has_pixels_and_not_too_many() {
        for (width, height) in [(0, 5), (5, 0), (1 << 16, 1 << 15)] {
            assert_eq!(Body::new(*body().start(), width, height), Err(CameraError::Size));
        }
    }
}
