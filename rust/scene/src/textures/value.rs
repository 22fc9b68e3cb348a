//! Parameters that are constants or textures.

use super::color_to_number::Mean;
use super::{Needs, Quantity, Texture, TexturePoint};
use raywright_optics::Rgb;
use std::sync::Arc;

/// A parameter of a material or a light, a color or a number: constant, or a texture.
#[derive(Clone, Debug)]
pub enum Value<T = Rgb> {
    /// A constant.
    Constant(T),
    /// A texture.
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

    /// Lower and upper bound of its values, per channel.
    pub fn range(&self) -> [T; 2] {
        match self {
            Self::Constant(value) => [*value; 2],
            Self::Texture(texture) => texture.range(),
        }
    }

    /// Returns whether all its values are within a range; false for NaN.
    pub fn is_within(&self, least: f64, most: f64) -> bool {
        let [low, high] = self.range();
        low.all(|low| low >= least) && high.all(|high| high <= most)
    }

    /// Approximate mean.
    pub fn mean(&self) -> T {
        match self {
            Self::Constant(value) => *value,
            Self::Texture(texture) => texture.mean(),
        }
    }

    /// The lookup data that evaluation needs.
    pub fn needs(&self) -> Needs {
        match self {
            Self::Constant(_) => Needs::NONE,
            Self::Texture(texture) => texture.needs(),
        }
    }

    /// Returns whether it is black, or 0, everywhere.
    pub fn is_black(&self) -> bool {
        self.range() == [T::ZERO; 2]
    }
}

impl Value {
    /// Converts a color to a number: the mean of its channels.
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

/// Constants compare by value, textures by identity.
impl<T: Quantity> PartialEq for Value<T> {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Constant(a), Self::Constant(b)) => a == b,
            (Self::Texture(a), Self::Texture(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}
