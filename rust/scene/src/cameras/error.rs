//! Errors in the description of a camera.

use std::fmt;

/// The reason why a camera cannot be built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CameraError {
    /// A coordinate is NaN or infinite.
    NotFinite,
    /// The target equals the position, or the direction is zero.
    NoDirection,
    /// The up vector is parallel to the viewing direction.
    NoUp,
    /// The field of view is outside the range of this kind of camera.
    FieldOfView,
    /// The picture has no pixel, or 2³¹ or more.
    Size,
    /// The shutter closes before it opens, or a time is outside [0, 1].
    Shutter,
    /// A focal length is zero, or a parameter of the film is not finite.
    Film,
    /// The lens has a negative radius, or one or two blades.
    Aperture,
    /// The focus distance is not positive and finite.
    Focus,
    /// The scale is not positive and finite.
    Scale,
}

impl fmt::Display for CameraError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "position, target and up of a camera must be finite",
            Self::NoDirection => "target of a camera must differ from its position",
            Self::NoUp => "up of a camera must not be zero or parallel to its view",
            Self::FieldOfView => {
                "fov of a camera must be between 0 and 180 degrees; of a fisheye, within the range of its mapping"
            }
            Self::Size => "width and height of a camera must be positive, and their product below 2**31",
            Self::Shutter => "shutter of a camera must have 0 <= open <= close <= 1",
            Self::Film => {
                "focal lengths of a camera must not be zero, and these, principal point and skew must be finite"
            }
            Self::Aperture => "lens of a camera must have a radius of at least 0, and 0 blades or at least 3",
            Self::Focus => "focus distance of a camera must be positive and finite",
            Self::Scale => "scale of a camera must be positive and finite",
        })
    }
}

impl std::error::Error for CameraError {}
