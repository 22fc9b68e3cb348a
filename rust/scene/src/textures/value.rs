//! What may be the same everywhere or a texture.

use super::mean::Mean;
use super::{Needs, Quantity, Texture, TexturePoint};
use raywright_optics::Rgb;
use std::sync::Arc;

/// A parameter of a material or a light, a colour or a number: the same everywhere, or a texture.
#[derive(Clone, Debug)]
pub enum Value<T = Rgb> {
    /// The same everywhere.
    Constant(T),
    /// What varies.
    Texture(Arc<dyn Texture<T>>),
}

impl<T: Quantity> Value<T> {
    /// Black, or 0.
    pub const ZERO: Self = Self::Constant(T::ZERO);

    /// Its value at a point.
    #[inline]
    pub fn at(&self, point: &TexturePoint) -> T {
        match self {
            Self::Constant(value) => *value,
            Self::Texture(texture) => texture.at(point),
        }
    }

    /// What its values lie between, channel by channel.
    pub fn range(&self) -> [T; 2] {
        match self {
            Self::Constant(value) => [*value; 2],
            Self::Texture(texture) => texture.range(),
        }
    }

    /// Whether all its values lie between two numbers; NaN does not.
    pub fn is_within(&self, least: f64, most: f64) -> bool {
        let [low, high] = self.range();
        low.all(|low| low >= least) && high.all(|high| high <= most)
    }

    /// Its mean, about.
    pub fn mean(&self) -> T {
        match self {
            Self::Constant(value) => *value,
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

    /// Whether it is black, or 0, everywhere.
    pub fn is_black(&self) -> bool {
        self.range() == [T::ZERO; 2]
    }
}

impl Value {
    /// As a number: the mean of the channels.
    pub fn number(&self) -> Value<f64> {
        match self {
            Self::Constant(rgb) => Value::Constant(rgb.mean()),
            Self::Texture(texture) => Value::Texture(Arc::new(Mean(texture.clone()))),
        }
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

impl From<f64> for Value<f64> {
    fn from(number: f64) -> Self {
        Self::Constant(number)
    }
}

/// Constants by their value, textures by identity.
impl<T: Quantity> PartialEq for Value<T> {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Constant(a), Self::Constant(b)) => a == b,
            (Self::Texture(a), Self::Texture(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}
