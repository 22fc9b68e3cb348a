//! Mixtures of two textures by a third.

use super::pattern::{blend, either};
use super::{Needs, Texture, TexturePoint, Value};
use raywright_optics::Rgb;

/// A linear interpolation of two values by a third, channel by channel.
#[derive(Clone, Debug)]
pub struct MixTexture {
    /// Value at amount 0.
    pub a: Value,
    /// Value at amount 1.
    pub b: Value,
    /// Share of `b`, clamped to [0, 1].
    pub amount: Value,
}

impl Texture for MixTexture {
    fn at(&self, point: &TexturePoint) -> Rgb {
        blend(self.a.at(point), self.b.at(point), share(self.amount.at(point)))
    }

    fn range(&self) -> [Rgb; 2] {
        either(&self.a, &self.b)
    }

    fn mean(&self) -> Rgb {
        blend(self.a.mean(), self.b.mean(), share(self.amount.mean()))
    }

    fn needs(&self) -> Needs {
        self.a.needs() | self.b.needs() | self.amount.needs()
    }
}

fn share(amount: Rgb) -> Rgb {
    amount.at_least(Rgb::ZERO).at_most(Rgb::ONE)
}
