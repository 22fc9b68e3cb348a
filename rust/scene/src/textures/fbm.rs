//! Fractal noise.

use super::{Domain, Needs, Pattern, TexturePoint, perlin};
use raywright_base::math::DVec3;

/// Octaves of noise, each finer and weaker than the one before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Octaves {
    /// Number of octaves.
    pub count: u32,
    /// Ratio of frequencies of consecutive octaves.
    pub lacunarity: f64,
    /// Ratio of amplitudes of consecutive octaves.
    pub gain: f64,
    /// Random seed.
    pub seed: u32,
}

impl Default for Octaves {
    /// Eight octaves, each twice as fine and half as strong.
    fn default() -> Self {
        Self { count: 8, lacunarity: 2.0, gain: 0.5, seed: 0 }
    }
}

impl Octaves {
    /// Footprints in cells between which noise fades out. Noise has hardly any frequencies above one per cell, which
    /// two samples per cell resolve.
    const FADES: [f64; 2] = [0.5, 1.0];

    /// The sum at a point with a footprint of `size`. Unresolved octaves are dropped, because their mean is 0.
    #[inline]
    pub fn sum(&self, point: DVec3, size: f64) -> f64 {
        let (mut sum, mut strength, mut frequency) = (0.0, 1.0, 1.0);
        for octave in 0..self.count {
            let left = Self::left(size * frequency);
            if left == 0.0 {
                // The lacunarity is above 1 in practice, so later octaves are unresolved too.
                break;
            }
            // Without an offset, the zeros of all lattices would coincide at the origin.
            let shift = DVec3::new(0.618_034, 0.414_214, 0.732_051) * f64::from(octave);
            sum += left * strength * perlin(point * frequency + shift, self.seed.wrapping_add(octave));
            strength *= self.gain;
            frequency *= self.lacunarity;
        }
        sum
    }

    /// Root-mean-square slope of the sum at this footprint. The slope of noise is about 1 per cell.
    #[inline]
    pub(super) fn slope(&self, size: f64) -> f64 {
        let (mut squares, mut each, mut frequency) = (0.0, 1.0, 1.0);
        for _ in 0..self.count {
            squares += (Self::left(size * frequency) * each).powi(2);
            each *= self.gain * self.lacunarity;
            frequency *= self.lacunarity;
        }
        squares.sqrt()
    }

    #[inline]
    fn left(width: f64) -> f64 {
        let [from, to] = Self::FADES;
        let t = ((width - from) / (to - from)).clamp(0.0, 1.0);
        1.0 - t * t * (3.0 - 2.0 * t)
    }
}

/// Fractional Brownian motion: clouds, stains, terrain (Mandelbrot and Van Ness, 1968; as a sum of noises: Perlin, "An
/// Image Synthesizer", 1985). The rare values beyond ±1 are clamped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fbm {
    /// Domain.
    pub domain: Domain,
    /// Octaves of the sum.
    pub octaves: Octaves,
}

impl Pattern for Fbm {
    #[inline]
    fn amount(&self, point: &TexturePoint) -> f64 {
        let place = self.domain.place(point);
        (0.5 + 0.5 * self.octaves.sum(place.point, place.size())).clamp(0.0, 1.0)
    }

    fn needs(&self) -> Needs {
        self.domain.needs()
    }
}

#[cfg(test)]
mod tests {
    use super::super::ObjectTransform;
    use super::*;

    /// Points distributed uniformly over some thousand cells.
    fn points() -> impl Iterator<Item = DVec3> {
        (1..20_000u32).map(|i| {
            let way = |step: f64| (f64::from(i) * step).fract() * 40.0;
            DVec3::new(way(0.819_172_513), way(0.671_043_606), way(0.549_700_477))
        })
    }

    #[test]
    fn octaves_finer_than_the_size_are_cut() {
        let octaves = |count| Octaves { count, ..Octaves::default() };
        for p in points().take(100) {
            // At a size of 1/8, octaves up to frequency 4 are resolved, and those from 8 on vanish.
            assert_eq!(octaves(8).sum(p, 0.125), octaves(3).sum(p, 0.0));
            assert_eq!(octaves(8).sum(p, 1.0), 0.0);
            let whole: f64 = octaves(5).sum(p, 0.0);
            assert_eq!(octaves(5).sum(p, 1e-9), whole);
        }
    }

    #[test]
    fn its_mean_is_the_middle() {
        for octaves in [Octaves::default(), Octaves { count: 1, ..Octaves::default() }] {
            let fbm = Fbm { domain: Domain::Object(ObjectTransform::default()), octaves };
            let (mut sum, mut count) = (0.0, 0.0);
            for position in points() {
                let amount = fbm.amount(&TexturePoint { position, ..TexturePoint::default() });
                assert!((0.0..=1.0).contains(&amount));
                sum += amount;
                count += 1.0;
            }
            // 64,000 cells with a deviation of about 0.15 each: five standard deviations are 0.003.
            assert!((sum / count - 0.5).abs() < 0.006, "{}", sum / count);
        }
    }

    #[test]
    fn its_slope_is_about_that_of_its_differences() {
        for octaves in [Octaves { count: 1, ..Octaves::default() }, Octaves { count: 4, ..Octaves::default() }] {
            let (mut squares, mut count) = (0.0, 0.0);
            for p in points() {
                let h = 1e-5;
                squares += ((octaves.sum(p + DVec3::X * h, 0.0) - octaves.sum(p, 0.0)) / h).powi(2);
                count += 1.0;
            }
            let found = f64::sqrt(squares / count);
            let told = octaves.slope(0.0);
            assert!(found / told > 0.4 && found / told < 1.2, "{found} {told}");
        }
    }
}
