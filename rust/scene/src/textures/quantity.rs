//! Value types of textures.

use raywright_optics::Rgb;
use std::fmt::{Debug, Display};

/// A color, or a number.
pub trait Quantity: Copy + Debug + Display + PartialEq + Send + Sync + 'static {
    /// Zero.
    const ZERO: Self;

    /// Returns whether a predicate holds for all channels.
    fn all(self, holds: impl Fn(f64) -> bool) -> bool;
}

impl Quantity for f64 {
    const ZERO: Self = 0.0;

    fn all(self, holds: impl Fn(f64) -> bool) -> bool {
        holds(self)
    }
}

impl Quantity for Rgb {
    const ZERO: Self = Self::ZERO;

    fn all(self, holds: impl Fn(f64) -> bool) -> bool {
        self.to_array().into_iter().all(holds)
    }
}
