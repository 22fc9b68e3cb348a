//! Vertex colors as a texture.

use super::{Needs, Texture, TexturePoint};
use raywright_optics::Rgb;

/// The interpolated vertex color, clamped to [0, 1]; white on meshes without vertex colors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VertexColours;

impl Texture for VertexColours {
    fn at(&self, point: &TexturePoint) -> Rgb {
        // Interpolating equal colors may differ from them by a rounding.
        point.colour.at_least(Rgb::ZERO).at_most(Rgb::ONE)
    }

    fn range(&self) -> [Rgb; 2] {
        [Rgb::ZERO, Rgb::ONE]
    }

    fn mean(&self) -> Rgb {
        Rgb::splat(0.5)
    }

    fn needs(&self) -> Needs {
        Needs { colours: true, ..Needs::NONE }
    }
}
