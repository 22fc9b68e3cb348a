//! Image textures.

use super::picture::Level;
use super::{Needs, Picture, Texture, TexturePoint, UvTransform};
use raywright_optics::Rgb;
use std::sync::Arc;

/// Treatment of coordinates beyond the edges of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// Repeat the picture.
    Repeat,
    /// Clamp to the edge.
    Clamp,
    /// Repeat the picture, mirrored every other time.
    Mirror,
}

/// Filtering of texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TexelFilter {
    /// The nearest texel.
    Nearest,
    /// Bilinear interpolation of four texels.
    Bilinear,
    /// Bilinear interpolation in the two mipmap levels closest to the footprint (Williams, "Pyramidal Parametrics",
    /// 1983).
    Trilinear,
}

/// A picture over texture coordinates from (0, 0) at its lower left to (1, 1).
#[derive(Clone, Debug)]
pub struct ImageTexture {
    /// The picture; with mipmap levels for [`TexelFilter::Trilinear`].
    pub picture: Arc<Picture>,
    /// Map from the surface's coordinates to those of the picture.
    pub uv: UvTransform,
    /// Wrapping along u and along v.
    pub wrap: [Wrap; 2],
    /// Filter.
    pub filter: TexelFilter,
}

impl Wrap {
    /// An equivalent coordinate near the picture, so that converting it to texels loses no digits.
    #[inline]
    fn near(self, x: f64) -> f64 {
        match self {
            Self::Repeat => x - x.floor(),
            Self::Mirror => x.rem_euclid(2.0),
            Self::Clamp => x.clamp(-1.0, 2.0),
        }
    }

    /// The texel index that replaces `i` in a row of `n`.
    #[inline]
    fn index(self, i: i64, n: usize) -> usize {
        let n = n as i64;
        let inside = match self {
            Self::Repeat => i.rem_euclid(n),
            Self::Clamp => i.clamp(0, n - 1),
            Self::Mirror => match i.rem_euclid(2 * n) {
                j if j < n => j,
                j => 2 * n - 1 - j,
            },
        };
        inside as usize
    }
}

impl ImageTexture {
    /// Value in a mipmap level, at a position from its upper left (0, 0) to (1, 1).
    #[inline]
    fn bilinear(&self, level: &Level, [s, t]: [f64; 2]) -> Rgb {
        let (x, y) = (s * level.width as f64 - 0.5, t * level.height as f64 - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let columns = [0, 1].map(|i| self.wrap[0].index(left as i64 + i, level.width));
        let [upper, lower] = [0, 1].map(|i| {
            let row = self.wrap[1].index(top as i64 + i, level.height);
            let [a, b] = columns.map(|column| level.texel(column, row));
            a + (b - a) * (x - left)
        });
        upper + (lower - upper) * (y - top)
    }

    /// Mipmap level at which a texel has this width in texture coordinates.
    #[inline]
    fn halvings(&self, width: f64) -> f64 {
        let full = self.picture.level(0);
        // On a surface without distortion, texels are as wide as high, whatever the picture's aspect ratio. So the
        // number of texels per area determines the level.
        let texels = width * (self.uv.determinant().abs() * (full.width * full.height) as f64).sqrt();
        if texels > 1.0 { texels.log2() } else { 0.0 }
    }
}

impl Texture for ImageTexture {
    fn at(&self, point: &TexturePoint) -> Rgb {
        let [u, v] = self.uv.point(point.uv);
        let at = [self.wrap[0].near(u), self.wrap[1].near(1.0 - v)];
        let value = match self.filter {
            TexelFilter::Nearest => {
                let level = self.picture.level(0);
                let index = |k: usize, n: usize| self.wrap[k].index((at[k] * n as f64).floor() as i64, n);
                level.texel(index(0, level.width), index(1, level.height))
            }
            TexelFilter::Bilinear => self.bilinear(self.picture.level(0), at),
            TexelFilter::Trilinear => {
                let halvings = self.halvings(point.width).min((self.picture.levels() - 1) as f64);
                let finer = halvings.floor();
                let value = self.bilinear(self.picture.level(finer as usize), at);
                if halvings > finer {
                    let coarser = self.bilinear(self.picture.level(finer as usize + 1), at);
                    value + (coarser - value) * (halvings - finer)
                } else {
                    value
                }
            }
        };
        // Rounding of the weighted sum may leave the range.
        let [low, high] = self.picture.range();
        value.at_least(low).at_most(high)
    }

    fn range(&self) -> [Rgb; 2] {
        self.picture.range()
    }

    fn mean(&self) -> Rgb {
        self.picture.mean()
    }

    fn needs(&self) -> Needs {
        Needs { uv: true, width: self.filter == TexelFilter::Trilinear, ..Needs::NONE }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Texels;
    use super::*;
    use proptest::prelude::*;

    fn texture(width: usize, height: usize, texels: Texels, wrap: Wrap, filter: TexelFilter) -> ImageTexture {
        let picture = Picture::new(width, height, texels, filter == TexelFilter::Trilinear).unwrap();
        ImageTexture { picture: Arc::new(picture), uv: UvTransform::default(), wrap: [wrap; 2], filter }
    }

    fn at(u: f64, v: f64, width: f64) -> TexturePoint {
        TexturePoint { uv: [u, v], width, ..TexturePoint::default() }
    }

    proptest! {
        #[test]
        fn ramps_come_out_as_they_went_in(u in 0.1..0.9f64, v in 0.1..0.9f64, dark in -1.0..1.0f32) {
            let (w, h) = (16u32, 8u32);
            // A linear function at texel centers, rows from the top.
            let f = |u: f32, v: f32| [dark + u, 2.0 * v - u, 0.25 * v];
            let all = (0..w * h).map(|i| {
                let middle = |k: u32, n: u32| (k as f32 + 0.5) / n as f32;
                f(middle(i % w, w), 1.0 - middle(i / w, h))
            });
            let ramp = texture(16, 8, Texels::Colour(all.collect()), Wrap::Clamp, TexelFilter::Bilinear);
            let value = ramp.at(&at(u, v, 0.0));
            let expected = Rgb::new(f64::from(dark) + u, 2.0 * v - u, 0.25 * v);
            prop_assert!((value - expected).abs().max() < 1e-6);
        }

        #[test]
        fn values_stay_in_the_range(u in -5.0..5.0f64, v in -5.0..5.0f64, width in 0.0..2.0f64, kind in 0usize..3) {
            let wrap = [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror][kind];
            let all = (0..7 * 5).map(|i| (i * i % 11) as u8 * 20 + 3).collect();
            let image = texture(7, 5, Texels::Grey8(all, true), wrap, TexelFilter::Trilinear);
            let ([low, high], value) = (image.range(), image.at(&at(u, v, width)));
            prop_assert!((0..3).all(|k| low[k] <= value[k] && value[k] <= high[k]));
        }
    }

    #[test]
    fn the_lower_left_is_at_zero() {
        // Two rows: 0 1 above, 2 3 below.
        let corners = Texels::Grey(vec![0.0, 1.0, 2.0, 3.0]);
        for filter in [TexelFilter::Nearest, TexelFilter::Bilinear, TexelFilter::Trilinear] {
            let image = texture(2, 2, corners.clone(), Wrap::Clamp, filter);
            for ([u, v], expected) in [([0.0, 0.0], 2.0), ([1.0, 0.0], 3.0), ([0.0, 1.0], 0.0), ([1.0, 1.0], 1.0)] {
                assert_eq!(image.at(&at(u, v, 0.0)), Rgb::splat(expected));
            }
            assert_eq!(image.at(&at(0.25, 0.25, 0.0)), Rgb::splat(2.0));
        }
        let image = texture(2, 2, corners, Wrap::Repeat, TexelFilter::Bilinear);
        assert_eq!(image.at(&at(0.5, 0.5, 0.0)), Rgb::splat(1.5));
        // Across the edge, where it repeats.
        assert_eq!(image.at(&at(0.0, 0.25, 0.0)), Rgb::splat(2.5));
        assert_eq!(image.at(&at(-7.0, 1e9 + 0.25, 0.0)), Rgb::splat(2.5));
    }

    #[test]
    fn edges_are_wrapped_as_asked() {
        let row = || Texels::Grey(vec![1.0, 2.0, 3.0]);
        let values = |wrap| {
            let image = texture(3, 1, row(), wrap, TexelFilter::Nearest);
            (-4..8).map(|i| image.at(&at((f64::from(i) + 0.5) / 3.0, 0.5, 0.0))[0]).collect::<Vec<_>>()
        };
        assert_eq!(values(Wrap::Repeat), [3.0, 1.0, 2.0, 3.0, 1.0, 2.0, 3.0, 1.0, 2.0, 3.0, 1.0, 2.0]);
        assert_eq!(values(Wrap::Clamp), [1.0, 1.0, 1.0, 1.0, 1.0, 2.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0]);
        assert_eq!(values(Wrap::Mirror), [3.0, 3.0, 2.0, 1.0, 1.0, 2.0, 3.0, 3.0, 2.0, 1.0, 1.0, 2.0]);
    }

    #[test]
    fn wide_looks_see_means() {
        let all: Vec<_> = (0..64).map(|i| f32::from(u8::from((i + i / 8) % 2 == 1))).collect();
        let image = texture(8, 8, Texels::Grey(all), Wrap::Repeat, TexelFilter::Trilinear);
        assert_eq!(image.at(&at(0.3, 0.4, 1.0)), Rgb::splat(0.5));
        assert_eq!(image.at(&at(0.3, 0.4, 2.0 / 8.0)), Rgb::splat(0.5));
        assert_eq!(image.at(&at(0.3, 0.4, 1e9)), image.mean());
        // Between two levels, linear in the logarithm: the finer shows the texel, the coarser the mean.
        let middle = |width: f64| image.at(&at(1.5 / 8.0, 0.5 / 8.0, width))[0];
        let whole = middle(0.0);
        assert!(whole == 0.0 || whole == 1.0);
        assert!((middle(2f64.sqrt() / 8.0) - (0.5 * whole + 0.25)).abs() < 1e-12);
        // A map that repeats the picture makes its texels smaller.
        let finer = ImageTexture { uv: UvTransform([[4.0, 0.0, 0.0], [0.0, 4.0, 0.0]]), ..image };
        assert_eq!(finer.halvings(2.0 / 8.0), 3.0);
    }
}
