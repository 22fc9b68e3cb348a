//! Pictures and their mipmaps.

use raywright_base::parallel;
use raywright_optics::Rgb;
use std::fmt;
use std::sync::LazyLock;

/// Decoded 8-bit values: linear, and by the sRGB transfer function (IEC 61966-2-1).
static DECODED: LazyLock<[[f64; 256]; 2]> = LazyLock::new(|| {
    let share = |i: usize| i as f64 / 255.0;
    let srgb = |c: f64| if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) };
    [std::array::from_fn(share), std::array::from_fn(|i| srgb(share(i)))]
});

/// Texels row by row from the top, in their input format: 8 bits or floats, gray or RGB.
#[derive(Clone)]
pub enum Texels {
    /// 8-bit gray; true if sRGB.
    Grey8(Vec<u8>, bool),
    /// 8-bit RGB; true if sRGB.
    Colour8(Vec<[u8; 3]>, bool),
    /// Gray floats.
    Grey(Vec<f32>),
    /// RGB floats.
    Colour(Vec<[f32; 3]>),
}

impl Texels {
    fn len(&self) -> usize {
        match self {
            Self::Grey8(all, _) => all.len(),
            Self::Colour8(all, _) => all.len(),
            Self::Grey(all) => all.len(),
            Self::Colour(all) => all.len(),
        }
    }

    #[cfg(test)]
    fn bytes(&self) -> usize {
        match self {
            Self::Grey8(all, _) => size_of_val(all.as_slice()),
            Self::Colour8(all, _) => size_of_val(all.as_slice()),
            Self::Grey(all) => size_of_val(all.as_slice()),
            Self::Colour(all) => size_of_val(all.as_slice()),
        }
    }

    #[inline]
    fn get(&self, i: usize) -> Rgb {
        match self {
            Self::Grey8(all, srgb) => Rgb::splat(DECODED[usize::from(*srgb)][usize::from(all[i])]),
            Self::Colour8(all, srgb) => {
                let table = &DECODED[usize::from(*srgb)];
                Rgb::from_array(all[i].map(|byte| table[usize::from(byte)]))
            }
            Self::Grey(all) => Rgb::splat(f64::from(all[i])),
            Self::Colour(all) => Rgb::from_array(all[i].map(f64::from)),
        }
    }

    fn is_grey(&self) -> bool {
        matches!(self, Self::Grey8(..) | Self::Grey(_))
    }
}

/// A mipmap level.
pub(super) struct Level {
    pub width: usize,
    pub height: usize,
    texels: Texels,
}

impl Level {
    /// The texel in a column and a row from the top.
    #[inline]
    pub fn texel(&self, x: usize, y: usize) -> Rgb {
        self.texels.get(y * self.width + x)
    }

    /// Halves width and height, rounded down; each texel is the mean of its part of the picture. For odd sizes, parts
    /// end within texels, which contribute proportionally (Guthe and Heckbert, "Non-Power-of-Two Mipmapping", 2005), so
    /// the mean is preserved.
    fn halved(&self) -> Self {
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        let row = |y: usize| {
            let down = taps(self.height, height, y);
            (0..width).map(move |x| {
                let across = taps(self.width, width, x);
                let mut mean = Rgb::ZERO;
                for (j, &weight) in down.1.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
                    for (i, &share) in across.1.iter().enumerate().filter(|(_, share)| **share > 0.0) {
                        mean += self.texel(across.0 + i, down.0 + j) * (weight * share);
                    }
                }
                mean
            })
        };
        let texels = if self.texels.is_grey() {
            let grey = |y| row(y).map(|mean| mean[0] as f32).collect();
            Texels::Grey(parallel::map::<Vec<_>>(height, grey).concat())
        } else {
            let colour = |y| row(y).map(|mean| mean.to_array().map(|x| x as f32)).collect();
            Texels::Colour(parallel::map::<Vec<_>>(height, colour).concat())
        };
        Self { width, height, texels }
    }
}

/// Weights for reducing a row of `n` texels to `m`: the first texel of the `i`th, and the weights of that and the next
/// two.
fn taps(n: usize, m: usize, i: usize) -> (usize, [f64; 3]) {
    if n == 1 {
        (0, [1.0, 0.0, 0.0])
    } else if n == 2 * m {
        (2 * i, [0.5, 0.5, 0.0])
    } else {
        (2 * i, [m - i, m, i + 1].map(|share| share as f64 / n as f64))
    }
}

/// A picture, with mipmap levels down to a single texel if they are needed.
pub struct Picture {
    levels: Vec<Level>,
    range: [Rgb; 2],
    mean: Rgb,
}

impl fmt::Debug for Picture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let first = self.level(0);
        write!(f, "Picture({} x {}, {} levels)", first.width, first.height, self.levels.len())
    }
}

/// The reason why a picture is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureError {
    /// It has no texels, or their number is not width times height.
    Size,
    /// A number in this row and column is NaN or infinite.
    NotFinite(usize, usize),
}

impl fmt::Display for PictureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Size => {
                f.write_str("a picture must have a width and a height above 0, and width times height points")
            }
            Self::NotFinite(row, column) => {
                write!(f, "a picture must be finite, got NaN or infinity in row {row}, column {column}")
            }
        }
    }
}

impl std::error::Error for PictureError {}

impl Picture {
    /// Creates a picture; `smaller` adds mipmap levels in floats, a third more texels.
    ///
    /// # Errors
    /// If the number of texels is wrong, or one is not finite.
    pub fn new(width: usize, height: usize, texels: Texels, smaller: bool) -> Result<Self, PictureError> {
        if texels.len() == 0 || width.checked_mul(height) != Some(texels.len()) {
            return Err(PictureError::Size);
        }
        let (mut range, mut sum) = ([Rgb::splat(f64::INFINITY), Rgb::splat(f64::NEG_INFINITY)], Rgb::ZERO);
        for i in 0..texels.len() {
            let value = texels.get(i);
            if !value.is_finite() {
                return Err(PictureError::NotFinite(i / width, i % width));
            }
            range = [range[0].at_most(value), range[1].at_least(value)];
            sum += value;
        }
        let mean = (sum / texels.len() as f64).at_least(range[0]).at_most(range[1]);
        let mut levels = vec![Level { width, height, texels }];
        while smaller && levels.last().is_some_and(|last| last.width > 1 || last.height > 1) {
            levels.extend(levels.last().map(Level::halved));
        }
        Ok(Self { levels, range, mean })
    }

    /// A mipmap level: 0 is the picture, the last a single texel.
    #[inline]
    pub(super) fn level(&self, i: usize) -> &Level {
        &self.levels[i.min(self.levels.len() - 1)]
    }

    /// Number of mipmap levels.
    pub fn levels(&self) -> usize {
        self.levels.len()
    }

    /// Lower and upper bound of its values, per channel.
    pub fn range(&self) -> [Rgb; 2] {
        self.range
    }

    /// Mean of all texels.
    pub fn mean(&self) -> Rgb {
        self.mean
    }

    /// Memory in bytes.
    #[cfg(test)]
    fn bytes(&self) -> usize {
        self.levels.iter().map(|level| level.texels.bytes() + size_of::<Level>()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use raywright_base::sampling::Sampler;

    fn mean(level: &Level) -> Rgb {
        let all = (0..level.width * level.height).map(|i| level.texel(i % level.width, i / level.width));
        all.sum::<Rgb>() / (level.width * level.height) as f64
    }

    proptest! {
        #[test]
        fn every_level_keeps_the_mean(width in 1usize..40, height in 1usize..40, seed: u64, kind in 0..4) {
            let drawn = |i: usize| Sampler::new(seed, 1, i as u32).two(0).map(|u| u as f32);
            let all = 0..width * height;
            let byte = |i: usize, k: usize| (drawn(3 * i + k)[0] * 256.0) as u8;
            let texels = match kind {
                0 => Texels::Grey8(all.map(|i| byte(i, 0)).collect(), true),
                1 => Texels::Colour8(all.map(|i| [byte(i, 0), byte(i, 1), byte(i, 2)]).collect(), false),
                2 => Texels::Grey(all.map(|i| 1e4 * drawn(i)[0]).collect()),
                _ => Texels::Colour(all.map(|i| [drawn(i)[0], drawn(i)[1] - 0.5, 0.25]).collect()),
            };
            let picture = Picture::new(width, height, texels, true).unwrap();
            let [low, high] = picture.range();
            for i in 0..picture.levels() {
                // Each level is rounded to f32, half an ulp of the largest value.
                let error = (i as f64 + 1.0) * 2f64.powi(-24) * low.abs().at_least(high.abs()).max();
                prop_assert!((mean(picture.level(i)) - picture.mean()).abs().max() <= error);
            }
            let last = picture.level(picture.levels() - 1);
            prop_assert_eq!((last.width, last.height), (1, 1));
        }
    }

    #[test]
    fn bytes_stay_bytes() {
        let texels = Texels::Colour8(vec![[0, 128, 255]; 64 * 32], true);
        let picture = Picture::new(64, 32, texels.clone(), false).unwrap();
        assert_eq!(picture.bytes(), 64 * 32 * 3 + size_of::<Level>());
        // A third more texels of 12 bytes.
        let more = Picture::new(64, 32, texels, true).unwrap().bytes();
        assert!(more < 64 * 32 * (3 + 4) + 600, "{more}");
    }

    #[test]
    fn srgb_is_decoded_as_its_standard_says() {
        let picture = Picture::new(4, 1, Texels::Grey8(vec![0, 10, 188, 255], true), false).unwrap();
        let values: Vec<f64> = (0..4).map(|x| picture.level(0).texel(x, 0)[0]).collect();
        // 10/255/12.92, and ((188/255 + 0.055) / 1.055)^2.4.
        for (value, expected) in values.iter().zip([0.0, 0.003_035_269_835_488_375, 0.502_886_458_032_568_6, 1.0]) {
            assert!((value - expected).abs() < 1e-15, "{value}");
        }
        let linear = Picture::new(1, 1, Texels::Grey8(vec![51], false), false).unwrap();
        assert_eq!(linear.mean(), Rgb::splat(0.2));
    }

    #[test]
    fn what_is_no_picture_is_refused() {
        let wrong = |width, height, texels| Picture::new(width, height, texels, true).err();
        assert_eq!(wrong(0, 3, Texels::Grey(vec![])), Some(PictureError::Size));
        assert_eq!(wrong(2, 2, Texels::Grey(vec![0.0; 3])), Some(PictureError::Size));
        let mut all = vec![[0.5; 3]; 6];
        all[4][1] = f32::NAN;
        assert_eq!(wrong(3, 2, Texels::Colour(all)), Some(PictureError::NotFinite(1, 1)));
    }
}
