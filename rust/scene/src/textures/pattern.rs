//! Two values, and a pattern that says how much of each.

use super::{Needs, Texture, TexturePoint, Value};
use raywright_optics::Rgb;
use std::fmt::Debug;

/// Says how far a texture has gone from one value to another.
pub trait Pattern: Debug + Send + Sync {
    /// 0 for the one, 1 for the other, and between them; averaged over the point's width.
    fn amount(&self, point: &TexturePoint) -> f64;

    /// Its mean over what it is put on, about.
    fn mean(&self) -> f64 {
        0.5
    }

    /// What it must know of a point.
    fn needs(&self) -> Needs;
}

/// A texture of two values, which may be textures themselves, by a pattern.
#[derive(Clone, Debug)]
pub struct Between<P> {
    /// What is where the pattern is 0.
    pub a: Value,
    /// What is where it is 1.
    pub b: Value,
    /// How much of each.
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

/// What lies between two colours, channel by channel, and never outside them however sums are rounded.
#[inline]
pub(super) fn blend(a: Rgb, b: Rgb, amount: Rgb) -> Rgb {
    (a + (b - a) * amount).at_least(a.at_most(b)).at_most(a.at_least(b))
}

/// The range of what is one of two values, or between them.
pub(super) fn either(a: &Value, b: &Value) -> [Rgb; 2] {
    let ([low, high], [least, most]) = (a.range(), b.range());
    [low.at_most(least), high.at_least(most)]
}
