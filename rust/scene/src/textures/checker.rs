//! Checkerboards.

use super::periodic_functions::pulse;
use super::{Domain, Needs, Pattern, TexturePoint};

/// Unit cells that alternate between 0 and 1 along each axis, box-filtered in closed form, so that they become uniform
/// gray in the distance.
///
/// In texture coordinates the cells are squares, with 0 at the lower left. In space they are cubes; on a surface
/// exactly between two layers the result is arbitrary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Checker(pub Domain);

impl Pattern for Checker {
    #[inline]
    fn amount(&self, point: &TexturePoint) -> f64 {
        let place = self.0.place(point);
        // A checkerboard is a product of square waves of 1 and −1, so its mean over a box is the product of their
        // means.
        let wave = |axis: usize| 2.0 * pulse(0.5 * place.point[axis], 0.5 * place.widths[axis], 0.5) - 1.0;
        let product: f64 = (0..place.axes).map(wave).product();
        0.5 - 0.5 * product
    }

    fn needs(&self) -> Needs {
        self.0.needs()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Between, ObjectTransform, Texture, UvTransform};
    use super::*;
    use proptest::prelude::*;
    use raywright_base::math::DVec3;
    use raywright_optics::Rgb;

    fn at(u: f64, v: f64, width: f64) -> TexturePoint {
        TexturePoint { uv: [u, v], width, ..TexturePoint::default() }
    }

    proptest! {
        #[test]
        fn its_mean_over_a_width_is_that_of_its_points(u in -3.0..3.0f64, v in -3.0..3.0f64, width in 0.01..3.0f64) {
            let checker = Checker(Domain::Uv(UvTransform::default()));
            let steps = 400;
            let sum: f64 = (0..steps * steps)
                .map(|i| {
                    let by = |k: i32| ((f64::from(k) + 0.5) / f64::from(steps) - 0.5) * width;
                    checker.amount(&at(u + by(i % steps), v + by(i / steps), 0.0))
                })
                .sum();
            // Each edge that crosses the box adds an error of half a row.
            let mean = sum / f64::from(steps * steps);
            prop_assert!((checker.amount(&at(u, v, width)) - mean).abs() < 5.0 / f64::from(steps));
        }
    }

    #[test]
    fn cells_alternate_from_the_lower_left() {
        let checker = Checker(Domain::Uv(UvTransform([[8.0, 0.0, 0.0], [0.0, 8.0, 0.0]])));
        for (i, j) in (0..16).flat_map(|i| (0..16).map(move |j| (i - 8, j - 8))) {
            let middle = |k: i32| (f64::from(k) + 0.5) / 8.0;
            assert_eq!(checker.amount(&at(middle(i), middle(j), 0.0)), f64::from((i + j).rem_euclid(2)));
            // A footprint within the cell has no effect.
            assert_eq!(checker.amount(&at(middle(i), middle(j), 0.12)), f64::from((i + j).rem_euclid(2)));
        }
        assert!((checker.amount(&at(0.3, 0.7, 1.0)) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn cubes_alternate_in_space() {
        let texture =
            Between { a: 0.25.into(), b: 0.75.into(), pattern: Checker(Domain::Object(ObjectTransform::default())) };
        let value = |x, y, z| {
            let position = DVec3::new(x, y, z);
            texture.at(&TexturePoint { position, ..TexturePoint::default() })
        };
        assert_eq!(value(0.5, 0.5, 0.5), Rgb::splat(0.25));
        assert_eq!(value(-0.5, 0.5, 0.5), Rgb::splat(0.75));
        assert_eq!(value(-0.5, 0.5, 1.5), Rgb::splat(0.25));
        assert_eq!(texture.range(), [Rgb::splat(0.25), Rgb::splat(0.75)]);
        assert_eq!(texture.mean(), Rgb::splat(0.5));
        assert_eq!(texture.needs(), Needs { position: true, width: true, ..Needs::NONE });
    }
}
