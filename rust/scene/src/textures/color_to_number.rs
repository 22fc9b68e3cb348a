//! Conversion of color textures to numbers.

use super::{Needs, Texture, TexturePoint};
use raywright_optics::Rgb;
use std::sync::Arc;

/// The mean of the channels of a texture.
#[derive(Clone, Debug)]
pub(super) struct Mean(pub Arc<dyn Texture>);

impl Texture<f64> for Mean {
    fn at(&self, point: &TexturePoint) -> f64 {
        self.0.at(point).mean()
    }

    fn range(&self) -> [f64; 2] {
        self.0.range().map(Rgb::mean)
    }

    fn mean(&self) -> f64 {
        self.0.mean().mean()
    }

    fn needs(&self) -> Needs {
        self.0.needs()
    }
}
