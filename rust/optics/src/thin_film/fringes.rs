//! Visibility of interference fringes.

use crate::Rgb;
use crate::spectra::{Illuminant, Response};
use std::f64::consts::TAU;
use std::sync::LazyLock;

/// Optical path difference, in nm, beyond which fringes are invisible; their remaining contrast is below 0.0013.
pub const FARTHEST: f64 = 48_000.0;

/// Step between entries, nm.
const STEP: f64 = 4.0;

/// Number of entries up to one beyond [`FARTHEST`], and one before 0.
const COUNT: usize = (FARTHEST / STEP) as usize + 4;

/// Color of daylight modulated by cos(2π x / λ), or by sin(2π x / λ), at each wavelength λ, for a path difference x:
/// Fourier transforms of the eye's response to daylight (Belcour and Barla, "A Practical Extension to Microfacet Theory
/// for the Modeling of Varying Iridescence", 2017). They use the weights at every nm, as all spectra do. Cubic
/// interpolation has an error of at most 1e-6.
static FRINGES: LazyLock<[Vec<Rgb>; 2]> = LazyLock::new(|| {
    let mut all = [vec![Rgb::ZERO; COUNT], vec![Rgb::ZERO; COUNT]];
    for (wavelength, weight) in Response::new(Illuminant::Daylight, 1).weights() {
        let (turn_sin, turn_cos) = (TAU * STEP / wavelength).sin_cos();
        // Starts at the entry before 0.
        let (mut cos, mut sin) = (turn_cos, -turn_sin);
        let [cosines, sines] = &mut all;
        for (cosine, sine) in cosines.iter_mut().zip(sines) {
            *cosine += weight * cos;
            *sine += weight * sin;
            (cos, sin) = (cos * turn_cos - sin * turn_sin, sin * turn_cos + cos * turn_sin);
        }
    }
    all
});

/// Colors of the cosine and the sine, for a non-negative path difference in nm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fringes {
    cosines: &'static [Rgb],
    sines: &'static [Rgb],
}

impl Fringes {
    /// The tables, computed on first use.
    #[inline]
    pub fn get() -> Self {
        let [cosines, sines] = &*FRINGES;
        Self { cosines, sines }
    }

    /// Color of the cosine.
    #[inline]
    pub fn cosine(&self, behind: f64) -> Rgb {
        if behind < FARTHEST { between(self.cosines, behind) } else { Rgb::ZERO }
    }

    /// Colors of the cosine and of the sine.
    #[inline]
    pub fn both(&self, behind: f64) -> [Rgb; 2] {
        if behind < FARTHEST { [between(self.cosines, behind), between(self.sines, behind)] } else { [Rgb::ZERO; 2] }
    }
}

/// Cubic interpolation of four entries.
#[inline]
fn between(table: &[Rgb], behind: f64) -> Rgb {
    let steps = behind * (1.0 / STEP);
    let before = steps as usize;
    let t = steps - before as f64;
    let (up, down) = (t + 1.0, 1.0 - t);
    let far = 2.0 - t;
    let near = &table[before..before + 4];
    (near[1] * (down * far * up) + near[2] * (t * up * far)) * 0.5
        - (near[0] * (down * far * t) + near[3] * (t * up * down)) * (1.0 / 6.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_the_transforms() {
        let daylight = Response::new(Illuminant::Daylight, 1);
        let fringes = Fringes::get();
        for i in 0..2000 {
            // Denser towards 0, and never exactly at an entry.
            let behind = 47_990.0 * (f64::from(i) / 2000.0).powi(3) + 0.1234;
            let truth = [f64::cos, f64::sin].map(|wave| daylight.seen(|wavelength| wave(TAU * behind / wavelength)));
            let [cosine, sine] = fringes.both(behind);
            let off = (cosine - truth[0]).abs().max().max((sine - truth[1]).abs().max());
            assert!(off < 1e-6 && fringes.cosine(behind) == cosine, "{behind} {off:e}");
        }
        assert!((fringes.cosine(0.0) - Rgb::ONE).abs().max() < 1e-12 && fringes.both(0.0)[1].abs().max() < 1e-12);
        // The contrast beyond the table.
        for i in 0..400 {
            let behind = FARTHEST + 97.0 * f64::from(i);
            for wave in [f64::cos, f64::sin] {
                assert!(daylight.seen(|wavelength| wave(TAU * behind / wavelength)).abs().max() < 1.3e-3);
            }
            assert_eq!(fringes.both(behind), [Rgb::ZERO; 2]);
        }
    }
}
