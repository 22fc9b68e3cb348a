//! Flags for the data of a lookup.

use std::ops::BitOr;

/// Flags for the data of a lookup; unused data is neither stored nor computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// Texture coordinates.
    pub uv: bool,
    /// Vertex colors.
    pub colours: bool,
    /// Position in the shape's space.
    pub position: bool,
    /// Ray footprint.
    pub width: bool,
    /// Derivatives of position and shading normal by the texture coordinates.
    pub tangents: bool,
    /// Wavelengths of the path.
    pub waves: bool,
}

impl Needs {
    /// No data.
    pub const NONE: Self =
        Self { uv: false, colours: false, position: false, width: false, tangents: false, waves: false };

    /// Returns whether any data is needed.
    pub fn any(self) -> bool {
        self != Self::NONE
    }

    /// Returns whether any data about the position is needed.
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
