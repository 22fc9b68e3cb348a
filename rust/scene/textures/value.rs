//! What may be the same everywhere or a texture.

use super::{Needs, Texture, TexturePoint};
use crate::optics::Rgb;
use std::sync::Arc;

/// A parameter of a material or a light: the same everywhere, or a texture.
#[derive(Clone, Debug)]
pub enum Value {
    /// The same everywhere.
    Constant(Rgb),
    /// What varies.
    Texture(Arc<dyn Texture>),
}

impl Value {
    /// Black.
    pub const ZERO: Self = Self::Constant(Rgb::ZERO);

    /// Its value at a point.
    #[inline]
    pub fn at(&self, point: &TexturePoint) -> Rgb {
        match self {
            Self::Constant(rgb) => *rgb,
            Self::Texture(texture) => texture.at(point),
        }
    }

    /// As one number: the mean of the channels.
    #[inline]
    pub fn number(&self, point: &TexturePoint) -> f64 {
        self.at(point).mean()
    }

    /// What its values lie between, channel by channel.
    pub fn range(&self) -> [Rgb; 2] {
        match self {
            Self::Constant(rgb) => [*rgb; 2],
            Self::Texture(texture) => texture.range(),
        }
    }

    /// Whether all its values lie between two numbers; NaN does not.
    pub fn is_within(&self, least: f64, most: f64) -> bool {
        let [low, high] = self.range();
        (0..3).all(|channel| low[channel] >= least && high[channel] <= most)
    }

    /// Its mean, about.
    pub fn mean(&self) -> Rgb {
        match self {
            Self::Constant(rgb) => *rgb,
            Self::Texture(texture) => texture.mean(),
        }
    }

    /// What it must know of a point.
    pub fn needs(&self) -> Needs {
        match self {
            Self::Constant(_) => Needs::NONE,
            Self::Texture(texture) => texture.needs(),
        }
    }

    /// Whether it is black everywhere.
    pub fn is_black(&self) -> bool {
        self.range() == [Rgb::ZERO; 2]
    }
}

impl From<Rgb> for Value {
    fn from(rgb: Rgb) -> Self {
        Self::Constant(rgb)
    }
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Self::Constant(Rgb::splat(number))
    }
}

/// Constants by their value, textures by identity.
impl PartialEq for Value {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Constant(a), Self::Constant(b)) => a == b,
            (Self::Texture(a), Self::Texture(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}
