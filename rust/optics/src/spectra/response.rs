//! Conversion of spectra to colors.

use super::super::Rgb;
use super::{FIRST, LAST, daylight, matching, xyz_to_rgb};
use std::sync::LazyLock;

/// An illuminant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Illuminant {
    /// Daylight, the white point.
    Daylight,
    /// Equal power at each wavelength. It is slightly red: (1.20, 0.95, 0.91).
    Even,
}

/// Weights that convert samples of a spectrum to linear Rec. 709. The spectrum is relative to the illuminant, or a
/// reflectance under it. The illuminant has luminance 1.
///
/// Weights are integrals of hat functions, so the conversion is exact for spectra that are piecewise linear between
/// samples, whatever the eye's response is in between.
#[derive(Clone, Debug)]
pub struct Response {
    step: f64,
    weights: Vec<Rgb>,
}

impl Response {
    /// Creates weights for samples at every `step` nm from [`FIRST`] on; the step divides the range of 470 nm.
    pub fn new(illuminant: Illuminant, step: u32) -> Self {
        debug_assert!(step > 0 && ((LAST - FIRST) as u32).is_multiple_of(step));
        let fine = &FINE[illuminant as usize];
        let step = step as usize;
        // Weights at 1 nm are distributed to the two adjacent samples.
        let mut weights = vec![Rgb::ZERO; (fine.len() - 1) / step + 1];
        for (nm, &seen) in fine.iter().enumerate() {
            let (before, share) = (nm / step, (nm % step) as f64 / step as f64);
            weights[before] += seen * (1.0 - share);
            if share > 0.0 {
                weights[before + 1] += seen * share;
            }
        }
        Self { step: step as f64, weights }
    }

    /// Wavelengths and their weights.
    pub fn weights(&self) -> impl ExactSizeIterator<Item = (f64, Rgb)> {
        self.weights.iter().enumerate().map(|(i, &weight)| (FIRST + self.step * i as f64, weight))
    }

    /// Color of a spectrum.
    pub fn seen(&self, spectrum: impl Fn(f64) -> f64) -> Rgb {
        self.weights().map(|(wavelength, weight)| weight * spectrum(wavelength)).sum()
    }
}

/// For each illuminant, the weights at every nm.
static FINE: LazyLock<[Vec<Rgb>; 2]> = LazyLock::new(|| {
    [Illuminant::Daylight, Illuminant::Even].map(|illuminant| {
        let nm = FIRST as u32..=LAST as u32;
        let power = |nm| if illuminant == Illuminant::Daylight { daylight(nm) } else { 1.0 };
        let xyz: Vec<_> = nm.map(f64::from).map(|nm| matching(nm) * power(nm)).collect();
        let luminance: f64 = xyz.iter().map(|xyz| xyz.y).sum();
        xyz.into_iter().map(|xyz| xyz_to_rgb(xyz / luminance)).collect()
    })
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_is_one_and_even_light_is_red() {
        for step in [1, 2, 5, 10] {
            let white = Response::new(Illuminant::Daylight, step).seen(|_| 1.0);
            assert!((white - Rgb::ONE).abs().max() < 1e-13, "{white}");
            // X = Y = Z = 1 by the matrix of IEC 61966-2-1.
            let even = Response::new(Illuminant::Even, step).seen(|_| 1.0);
            assert!((even - Rgb::new(1.2048, 0.9484, 0.9088)).abs().max() < 2e-3, "{even}");
            // Daylight has the same color, whether as a spectrum or as the illuminant.
            let day = Response::new(Illuminant::Even, step).seen(daylight);
            assert!((day / day[1] - Rgb::ONE).abs().max() < if step == 1 { 1e-13 } else { 2e-3 }, "{day}");
        }
    }

    #[test]
    fn lines_are_seen_alike_by_any_step() {
        let slope = |nm: f64| 0.3 + (nm - 500.0) / 400.0;
        for illuminant in [Illuminant::Daylight, Illuminant::Even] {
            let fine = Response::new(illuminant, 1).seen(slope);
            for step in [2, 5, 10, 47, 470] {
                let seen = Response::new(illuminant, step).seen(slope);
                assert!((seen - fine).abs().max() < 1e-12, "{step} {seen} {fine}");
            }
        }
    }

    #[test]
    fn shares_of_the_spectrum_have_their_colours() {
        let all = Response::new(Illuminant::Daylight, 1);
        let between = |from: f64, to: f64| all.seen(|nm| f64::from(u8::from((from..to).contains(&nm))));
        let (blue, green, red) = (between(360.0, 495.0), between(495.0, 575.0), between(575.0, 831.0));
        assert!(blue.max() == blue[2] && green.max() == green[1] && red.max() == red[0]);
        assert!((blue + green + red - Rgb::ONE).abs().max() < 1e-13);
    }
}
