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
}

impl Needs {
    /// Nothing.
    pub const NONE: Self = Self { uv: false, colours: false, position: false, width: false, tangents: false };

    /// Whether anything is.
    pub fn any(self) -> bool {
        self != Self::NONE
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
        }
    }
}
