//! Products of textures.

use super::{Needs, Texture, TexturePoint, Value};
use raywright_optics::Rgb;

/// The product of two values, channel by channel; with a constant it brightens or darkens a texture.
#[derive(Clone, Debug)]
pub struct ProductTexture {
    /// First factor.
    pub a: Value,
    /// Second factor.
    pub b: Value,
}

impl Texture for ProductTexture {
    fn at(&self, point: &TexturePoint) -> Rgb {
        self.a.at(point) * self.b.at(point)
    }

    fn range(&self) -> [Rgb; 2] {
        let ([a, b], [c, d]) = (self.a.range(), self.b.range());
        // The bounds of a product of intervals are products of their bounds, and rounding is monotonic.
        let ends = [a * c, a * d, b * c, b * d];
        [ends.into_iter().reduce(Rgb::at_most), ends.into_iter().reduce(Rgb::at_least)]
            .map(|end| end.unwrap_or(Rgb::splat(f64::NAN)))
    }

    fn mean(&self) -> Rgb {
        self.a.mean() * self.b.mean()
    }

    fn needs(&self) -> Needs {
        self.a.needs() | self.b.needs()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Between, Checker, Domain, MixTexture, UvTransform};
    use super::*;
    use std::sync::Arc;

    fn checker(a: Rgb, b: Rgb) -> Value {
        let pattern = Checker(Domain::Uv(UvTransform::default()));
        Value::Texture(Arc::new(Between { a: a.into(), b: b.into(), pattern }))
    }

    #[test]
    fn ranges_hold_what_products_and_mixes_take() {
        let (a, b) =
            (checker(Rgb::new(-1.0, 0.2, 0.0), Rgb::new(2.0, 0.5, 1.0)), checker(Rgb::splat(-3.0), Rgb::splat(0.5)));
        let product = ProductTexture { a: a.clone(), b: b.clone() };
        assert_eq!(product.range(), [Rgb::new(-6.0, -1.5, -3.0), Rgb::new(3.0, 0.25, 0.5)]);
        let mix = MixTexture { a: a.clone(), b: b.clone(), amount: Rgb::new(0.5, -1.0, 7.0).into() };
        assert_eq!(mix.range(), [Rgb::splat(-3.0), Rgb::new(2.0, 0.5, 1.0)]);
        for width in [0.0, 0.3, 2.0] {
            let point = TexturePoint { uv: [0.9, 1.2], width, ..TexturePoint::default() };
            let (x, y) = (a.at(&point), b.at(&point));
            assert_eq!(product.at(&point), x * y);
            assert_eq!(mix.at(&point), Rgb::new(0.5 * (x[0] + y[0]), x[1], y[2]));
        }
    }
}
