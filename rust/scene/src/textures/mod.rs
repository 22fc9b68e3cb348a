//! Textures: one interface, and one file each.

mod checker;
mod color_to_number;
mod domain;
mod fbm;
mod image;
mod marble;
mod mix;
mod needs;
mod noise;
mod pattern;
mod periodic_functions;
mod perlin;
mod picture;
mod product;
mod quantity;
mod spectral;
mod stripes;
mod value;
mod vertex_colours;
mod wood;

pub use checker::Checker;
pub use domain::{Domain, ObjectTransform, UvTransform};
pub use fbm::{Fbm, Octaves};
pub use image::{ImageTexture, TexelFilter, Wrap};
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

/// Data of a texture lookup.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TexturePoint {
    /// Texture coordinates; (0, 0) is the lower left of a picture.
    pub uv: [f64; 2],
    /// Approximate footprint of the ray in `uv`, over which textures average. 0 for a point.
    pub width: f64,
    /// Position in the space where the shape was described; for an instance, that of its prototype.
    pub position: DVec3,
    /// Footprint in terms of the position.
    pub size: f64,
    /// Interpolated vertex color; white if the mesh has none.
    pub colour: Rgb,
    /// Wavelengths, one per lane; `None` for red, green and blue.
    pub waves: Option<Waves>,
}

impl TexturePoint {
    /// For constants, which ignore the lookup data.
    pub const NOWHERE: Self =
        Self { uv: [0.0; 2], width: 0.0, position: DVec3::ZERO, size: 0.0, colour: Rgb::ONE, waves: None };
}

impl Default for TexturePoint {
    fn default() -> Self {
        Self::NOWHERE
    }
}

/// A texture: a color, such as reflectance or radiance, or a number, such as roughness.
pub trait Texture<T = Rgb>: Debug + Send + Sync {
    /// The value at a point, averaged over the footprint.
    fn at(&self, point: &TexturePoint) -> T;

    /// Lower and upper bound of its values, per channel.
    fn range(&self) -> [T; 2];

    /// Approximate mean over the surface, for light selection.
    fn mean(&self) -> T;

    /// The lookup data that evaluation needs.
    fn needs(&self) -> Needs;
}
