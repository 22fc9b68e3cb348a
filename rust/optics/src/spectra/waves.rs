//! The wavelengths of a path.

use super::super::Rgb;
use super::{FIRST, Illuminant, LAST, Response};
use std::sync::LazyLock;

/// Three wavelengths of a path in place of red, green and blue (Wilkie et al., "Hero Wavelength Spectral Sampling",
/// 2014), nm. Each is sampled in proportion to the visibility of white light, and the three are stratified over it. The
/// first is the hero: at dispersive interfaces the path follows it.
///
/// Radiance at them is relative to daylight, so that a reflectance of 1 at all wavelengths is white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waves([f64; 3]);

impl Waves {
    /// Samples wavelengths by a number in [0, 1).
    pub fn of(u: f64) -> Self {
        let drawn = &*DRAWN;
        Self([0.0, 1.0, 2.0].map(|third| drawn.wavelength((u + third / 3.0).fract())))
    }

    /// The hero wavelength, which determines the path under dispersion.
    #[inline]
    pub fn hero(&self) -> f64 {
        self.0[0]
    }

    /// Replaces all three by the hero.
    #[inline]
    pub fn alone(&self) -> Self {
        Self([self.0[0]; 3])
    }

    /// The wavelengths.
    #[inline]
    pub fn all(&self) -> [f64; 3] {
        self.0
    }

    /// Evaluates a function of wavelength at each.
    #[inline]
    pub fn lanes(&self, f: impl Fn(f64) -> f64) -> Rgb {
        Rgb::from_array(self.0.map(f))
    }

    /// Converts radiance at the wavelengths to linear Rec. 709. Its expectation is the color of the spectrum. A single
    /// sample has the color of its wavelengths, which is negative in some channels.
    #[inline]
    pub fn seen(&self, light: Rgb) -> Rgb {
        let of = |lane: usize| DRAWN.colours[cell(self.0[lane])] * light[lane];
        of(0) + of(1) + of(2)
    }

    /// Radiance after termination of the secondary wavelengths: the hero's, times three.
    #[inline]
    pub fn ended(light: Rgb) -> Rgb {
        Rgb::new(3.0 * light[0], 0.0, 0.0)
    }

    /// Radiance of two connected subpaths that both terminated the secondary wavelengths: the factor of three applies
    /// only once.
    #[inline]
    pub fn joined(light: Rgb) -> Rgb {
        light / 3.0
    }
}

/// Distribution of wavelengths: a probability per nm, uniform within.
struct Drawn {
    /// Cumulative probabilities, ending with 1.
    before: Vec<f64>,
    /// Of equal parts of [0, 1), and of its end, the index of the first probability above the part's start.
    first: Vec<u16>,
    /// Color of each nm over the density of three samples.
    colours: Vec<Rgb>,
}

static DRAWN: LazyLock<Drawn> = LazyLock::new(|| {
    let seen: Vec<Rgb> = Response::new(Illuminant::Daylight, 1).weights().map(|(_, weight)| weight).collect();
    // Minimizes the sum of the channels' variances for white light.
    let wanted: Vec<f64> = seen.iter().map(|colour| colour.dot(*colour).sqrt()).collect();
    let all: f64 = wanted.iter().sum();
    let mut before = vec![0.0];
    let mut sum = 0.0;
    for one in &wanted {
        sum += one / all;
        before.push(sum);
    }
    *before.last_mut().expect("there are wavelengths") = 1.0;
    let first = (0..=PARTS).map(|part| above(&before, 0, part as f64 / PARTS as f64) as u16).collect();
    let colours = seen.iter().zip(&wanted).map(|(&colour, &one)| colour * (all / (3.0 * one))).collect();
    Drawn { before, first, colours }
});

/// Number of equal parts, some for each nm.
const PARTS: usize = 2048;

/// The index of the first number above `u` in ascending ones, which is not below `start`.
#[inline]
fn above(before: &[f64], start: usize, u: f64) -> usize {
    start + before[start..].iter().take_while(|&&before| before <= u).count()
}

impl Drawn {
    fn wavelength(&self, u: f64) -> f64 {
        let start = self.first[(u * PARTS as f64) as usize].into();
        let after = above(&self.before, start, u).clamp(1, self.colours.len());
        let (from, to) = (self.before[after - 1], self.before[after]);
        let nm = FIRST + (after - 1) as f64 - 0.5 + (u - from) / (to - from);
        nm.clamp(FIRST, LAST)
    }
}

/// Index of the nm of a wavelength.
#[inline]
fn cell(wavelength: f64) -> usize {
    (wavelength - (FIRST - 0.5)) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean over stratified samples in [0, 1).
    fn mean(of: impl Fn(&Waves) -> Rgb) -> Rgb {
        let count = 30_000;
        (0..count).map(|i| of(&Waves::of((f64::from(i) + 0.5) / f64::from(count)))).sum::<Rgb>() / f64::from(count)
    }

    #[test]
    fn white_is_white_and_colours_are_what_is_seen_of_them() {
        assert!((mean(|waves| waves.seen(Rgb::ONE)) - Rgb::ONE).abs().max() < 1e-4);
        let slope = |nm: f64| 0.2 + 0.6 * ((nm - 500.0) / 60.0).tanh().abs();
        let truth = Response::new(Illuminant::Daylight, 1).seen(slope);
        let found = mean(|waves| waves.seen(waves.lanes(slope)));
        assert!((found - truth).abs().max() < 5e-4, "{found} {truth}");
        // The same with the hero alone.
        let found = mean(|waves| waves.seen(Waves::ended(waves.lanes(slope))));
        assert!((found - truth).abs().max() < 5e-4, "{found} {truth}");
    }

    #[test]
    fn wavelengths_are_seen_and_share_out_what_is() {
        for i in 0..1000 {
            let all = Waves::of(f64::from(i) / 1000.0).all();
            assert!(all.iter().all(|nm| (FIRST..=LAST).contains(nm)));
        }
        let [a, b, c] = Waves::of(0.1).all();
        assert!(a < b && b < c);
        assert_eq!(Waves::of(0.1 + 1.0 / 3.0).hero(), b);
    }
}
