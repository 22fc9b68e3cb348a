//! The colours of a mesh's vertices.

use super::{Needs, Texture, TexturePoint};
use raywright_optics::Rgb;

/// The colour of the mesh's vertices, between them in proportion; white on what has none. Beyond 0 and 1 it counts as
/// these.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VertexColours;

impl Texture for VertexColours {
    fn at(&self, point: &TexturePoint) -> Rgb {
        // Colours of one alike may come out a rounding apart from it.
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
