//! What is no camera.

use std::fmt;

/// Why there is no such camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CameraError {
    /// A coordinate is NaN or infinite.
    NotFinite,
    /// The target is where the camera is, or the direction is zero.
    NoDirection,
    /// The direction that is up is the one it looks in.
    NoUp,
    /// The field of view is not one that the kind of camera can have.
    FieldOfView,
    /// There is no pixel, or 2³¹ of them or more.
    Size,
    /// The shutter closes before it opens, or is open outside of the scene's time.
    Shutter,
    /// A focal length is zero, or the film's numbers are not finite.
    Film,
    /// The lens has a negative radius, or one or two blades.
    Aperture,
    /// What is in focus is not in front of the camera.
    Focus,
    /// The picture shows nothing, or all there is.
    Scale,
}

impl fmt::Display for CameraError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "position, target and up of a camera must be finite",
            Self::NoDirection => "target of a camera must differ from its position",
            Self::NoUp => "up of a camera must not be zero or parallel to its view",
            Self::FieldOfView => {
                "fov of a camera must lie between 0 and 180 degrees; of a fisheye, within what its mapping can show"
            }
            Self::Size => "width and height of a camera must be positive, and their product below 2**31",
            Self::Shutter => "shutter of a camera must open at 0 or later, and close no earlier, at 1 at the latest",
            Self::Film => {
                "focal lengths of a camera must not be zero, and these, principal point and skew must be finite"
            }
            Self::Aperture => "the lens of a camera must have a radius of at least 0, and 0 blades or at least 3",
            Self::Focus => "the distance in focus of a camera must be positive and finite",
            Self::Scale => "scale of a camera must be positive and finite",
        })
    }
}

impl std::error::Error for CameraError {}
