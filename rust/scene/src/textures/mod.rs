//! What varies over surfaces: one interface over all textures.

mod checker;
mod domain;
mod fbm;
mod image;
mod marble;
mod mean;
mod mix;
mod needs;
mod noise;
mod pattern;
mod perlin;
mod picture;
mod product;
mod quantity;
mod spectral;
mod stripes;
mod value;
mod vertex_colours;
mod waves;
mod wood;

pub use checker::Checker;
pub use domain::{Domain, ObjectTransform, UvTransform};
pub use fbm::{Fbm, Octaves};
pub use image::{Filter, ImageTexture, Wrap};
pub use marble::Marble;
pub use mix::MixTexture;
pub use needs::Needs;
pub use noise::Noise;
pub use pattern::{Between, Pattern};
pub use perlin::perlin;
pub use picture::{Picture, PictureError, Texels};
pub use product::ProductTexture;
pub use quantity::Quantity;
pub use spectral::{Spectral, Upsampled};
pub use stripes::Stripes;
pub use value::Value;
pub use vertex_colours::VertexColours;
pub use wood::Wood;

use raywright_base::math::DVec3;
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use std::fmt::Debug;

/// Where a texture is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TexturePoint {
    /// Texture coordinates; (0, 0) is the lower left of a picture.
    pub uv: [f64; 2],
    /// How far apart in `uv` the points are that neighbouring rays meet, about: what is smaller cannot be told apart,
    /// and is to be averaged over. 0 for a point.
    pub width: f64,
    /// The point in the space that its shape was described in: of what stands in an instance, in that of its prototype.
    pub position: DVec3,
    /// As `width`, of the position.
    pub size: f64,
    /// The colour of the mesh's vertices there; white where it has none.
    pub colour: Rgb,
    /// The wavelengths that are asked for, a lane each; none for red, green and blue.
    pub waves: Option<Waves>,
}

impl TexturePoint {
    /// For what asks nothing of a point.
    pub const NOWHERE: Self =
        Self { uv: [0.0; 2], width: 0.0, position: DVec3::ZERO, size: 0.0, colour: Rgb::ONE, waves: None };
}

impl Default for TexturePoint {
    fn default() -> Self {
        Self::NOWHERE
    }
}

/// What varies over surfaces: a colour, as of reflectance or radiance, or a number, as of roughness.
pub trait Texture<T = Rgb>: Debug + Send + Sync {
    /// The value at a point, averaged over its width.
    fn at(&self, point: &TexturePoint) -> T;

    /// What its values lie between, channel by channel.
    fn range(&self) -> [T; 2];

    /// Its mean over what it is put on, about: lights are chosen by it.
    fn mean(&self) -> T;

    /// What it must know of a point.
    fn needs(&self) -> Needs;
}
