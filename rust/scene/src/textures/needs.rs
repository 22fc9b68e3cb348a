//! What must be known of a point to shade it.

use std::ops::BitOr;

/// What must be known of a point to shade it: what nobody asks for is neither kept nor computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// Texture coordinates.
    pub uv: bool,
    /// Colours of vertices.
    pub colours: bool,
    /// The point in its shape's space.
    pub position: bool,
    /// How far apart neighbouring rays meet the surface.
    pub width: bool,
    /// How the point and the shading normal change with the texture coordinates.
    pub tangents: bool,
    /// The wavelengths that the path carries which has come there.
    pub waves: bool,
}

impl Needs {
    /// Nothing.
    pub const NONE: Self =
        Self { uv: false, colours: false, position: false, width: false, tangents: false, waves: false };

    /// Whether anything is.
    pub fn any(self) -> bool {
        self != Self::NONE
    }

    /// Whether anything is of where it lies.
    pub fn of_place(self) -> bool {
        Self { waves: false, ..self }.any()
    }
}

impl BitOr for Needs {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self {
            uv: self.uv | other.uv,
            colours: self.colours | other.colours,
            position: self.position | other.position,
            width: self.width | other.width,
            tangents: self.tangents | other.tangents,
            waves: self.waves | other.waves,
        }
    }
}
