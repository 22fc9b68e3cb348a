//! Interpolation of two values by a pattern.

use super::{Needs, Texture, TexturePoint, Value};
use raywright_optics::Rgb;
use std::fmt::Debug;

/// A pattern that interpolates between two values.
pub trait Pattern: Debug + Send + Sync {
    /// The amount between 0 and 1, averaged over the footprint.
    fn amount(&self, point: &TexturePoint) -> f64;

    /// Approximate mean over the surface.
    fn mean(&self) -> f64 {
        0.5
    }

    /// The lookup data that evaluation needs.
    fn needs(&self) -> Needs;
}

/// A texture of two values, which may be textures themselves, interpolated by a pattern.
#[derive(Clone, Debug)]
pub struct Between<P> {
    /// Value at amount 0.
    pub a: Value,
    /// Value at amount 1.
    pub b: Value,
    /// The interpolation.
    pub pattern: P,
}

impl<P: Pattern> Texture for Between<P> {
    fn at(&self, point: &TexturePoint) -> Rgb {
        blend(self.a.at(point), self.b.at(point), Rgb::splat(self.pattern.amount(point)))
    }

    fn range(&self) -> [Rgb; 2] {
        either(&self.a, &self.b)
    }

    fn mean(&self) -> Rgb {
        blend(self.a.mean(), self.b.mean(), Rgb::splat(self.pattern.mean()))
    }

    fn needs(&self) -> Needs {
        self.a.needs() | self.b.needs() | self.pattern.needs()
    }
}

/// Interpolates two colors, channel by channel, and clamps the result between them against rounding.
#[inline]
pub(super) fn blend(a: Rgb, b: Rgb, amount: Rgb) -> Rgb {
    (a + (b - a) * amount).at_least(a.at_most(b)).at_most(a.at_least(b))
}

/// Range of an interpolation of two values.
pub(super) fn either(a: &Value, b: &Value) -> [Rgb; 2] {
    let ([low, high], [least, most]) = (a.range(), b.range());
    [low.at_most(least), high.at_least(most)]
}
