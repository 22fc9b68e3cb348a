//! Where a picture is seen from.

use crate::math::{DVec3, Ray};
use std::fmt;

/// A pinhole camera. It looks along its own −z with +y up; row 0 of its picture is at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    position: DVec3,
    forward: DVec3,
    /// Half the picture's width at distance 1, to the right.
    right: DVec3,
    /// Half the picture's height at distance 1, upwards.
    up: DVec3,
    width: u32,
    height: u32,
}

/// Why there is no such camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CameraError {
    /// A coordinate is NaN or infinite.
    NotFinite,
    /// The target is where the camera is.
    NoDirection,
    /// The direction that is up is the one it looks in.
    NoUp,
    /// The field of view is not between 0 and 180 degrees.
    FieldOfView,
    /// There is no pixel, or more than 2³¹ of them.
    Size,
}

impl fmt::Display for CameraError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "position, target and up of a camera must be finite",
            Self::NoDirection => "target of a camera must differ from its position",
            Self::NoUp => "up of a camera must not be zero or parallel to its view",
            Self::FieldOfView => "fov of a camera must lie between 0 and 180 degrees",
            Self::Size => "width and height of a camera must be positive, and their product below 2**31",
        })
    }
}

impl std::error::Error for CameraError {}

impl Camera {
    /// A camera at `position` that looks at `target`, turned so that `up` points upwards in the picture, with a
    /// vertical field of view in degrees and square pixels.
    pub fn perspective(
        position: DVec3,
        target: DVec3,
        up: DVec3,
        fov: f64,
        width: u32,
        height: u32,
    ) -> Result<Self, CameraError> {
        if !(position.is_finite() && target.is_finite() && up.is_finite()) {
            return Err(CameraError::NotFinite);
        }
        if width == 0 || height == 0 || u64::from(width) * u64::from(height) >= 1 << 31 {
            return Err(CameraError::Size);
        }
        if !(fov > 0.0 && fov < 180.0) {
            return Err(CameraError::FieldOfView);
        }
        // Halved, so that the difference of any two finite points is finite.
        let forward = unit(0.5 * target - 0.5 * position).ok_or(CameraError::NoDirection)?;
        let up = unit(up).ok_or(CameraError::NoUp)?;
        // Closer than 10⁻⁸ radians to the view, the rounding of the view would decide what is up.
        let right = Some(forward.cross(up)).filter(|r| r.length() > 1e-8).ok_or(CameraError::NoUp)?.normalize();
        let half_height = (0.5 * fov).to_radians().tan();
        let half_width = half_height * f64::from(width) / f64::from(height);
        let up = right.cross(forward) * half_height;
        Ok(Self { position, forward, right: right * half_width, up, width, height })
    }

    /// Pixels in a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Where it is, and three axes: the view, of unit length, half the picture's width at distance 1, and half its height.
    pub fn axes(&self) -> (DVec3, [DVec3; 3]) {
        (self.position, [self.forward, self.right, self.up])
    }

    /// The ray, of unit direction, through a point of the film: `x` in pixels from the left, `y` from the top.
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        let right = 2.0 * x / f64::from(self.width) - 1.0;
        let up = 1.0 - 2.0 * y / f64::from(self.height);
        Ray::new(self.position, (self.forward + self.right * right + self.up * up).normalize())
    }
}

/// The unit vector along `v`, of whatever length; `None` for zero.
fn unit(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    (largest > 0.0).then(|| (v / largest).normalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(position: DVec3, target: DVec3, up: DVec3, fov: f64) -> Result<Camera, CameraError> {
        Camera::perspective(position, target, up, fov, 4, 2)
    }

    #[test]
    fn looks_along_minus_z_with_row_0_on_top() {
        let camera = camera(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, 90.0).unwrap();
        let close = |a: DVec3, b: DVec3| assert!((a - b.normalize()).length() < 1e-15, "{a} {b}");
        close(camera.ray(2.0, 1.0).direction, DVec3::NEG_Z);
        // 90 degrees over two rows: half the height is 1, half the width 2.
        close(camera.ray(0.0, 0.0).direction, DVec3::new(-2.0, 1.0, -1.0));
        close(camera.ray(4.0, 2.0).direction, DVec3::new(2.0, -1.0, -1.0));
        close(camera.ray(2.0, 0.0).direction, DVec3::new(0.0, 1.0, -1.0));
    }

    #[test]
    fn up_need_not_be_at_right_angles() {
        let a = camera(DVec3::new(5.0, 2.0, 1.0), DVec3::ZERO, DVec3::Y, 40.0).unwrap();
        let b = camera(DVec3::new(5.0, 2.0, 1.0), DVec3::ZERO, DVec3::new(5.0, 12.0, 1.0), 40.0).unwrap();
        assert!((a.ray(0.3, 0.1).direction - b.ray(0.3, 0.1).direction).length() < 1e-14);
    }

    #[test]
    fn lengths_do_not_matter() {
        for scale in [1e-300, 1e-30, 1e300] {
            let a = camera(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0) * scale, DVec3::Y / scale, 30.0).unwrap();
            let b = camera(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0), DVec3::Y, 30.0).unwrap();
            assert!((a.ray(0.0, 2.0).direction - b.ray(0.0, 2.0).direction).length() < 1e-14);
        }
        assert!(camera(DVec3::splat(f64::MAX), DVec3::splat(-f64::MAX), DVec3::Y, 30.0).is_ok());
    }

    #[test]
    fn refuses_what_is_no_camera() {
        let (o, z, y) = (DVec3::ZERO, DVec3::Z, DVec3::Y);
        assert_eq!(camera(z, z, y, 30.0), Err(CameraError::NoDirection));
        assert_eq!(camera(o, z, z, 30.0), Err(CameraError::NoUp));
        assert_eq!(camera(o, z, -2.0 * z, 30.0), Err(CameraError::NoUp));
        assert_eq!(camera(o, z, o, 30.0), Err(CameraError::NoUp));
        assert_eq!(camera(o, z * f64::NAN, y, 30.0), Err(CameraError::NotFinite));
        for fov in [0.0, 180.0, -5.0, f64::NAN] {
            assert_eq!(camera(o, z, y, fov), Err(CameraError::FieldOfView));
        }
        for (width, height) in [(0, 5), (5, 0), (1 << 16, 1 << 15)] {
            assert_eq!(Camera::perspective(o, z, y, 30.0, width, height), Err(CameraError::Size));
        }
    }
}
