//! Black-body radiation.

use super::super::Rgb;
use super::{Illuminant, Response};
use std::sync::LazyLock;

/// Radiance of a black body at a wavelength in nm, relative to its maximum over all wavelengths (Planck, 1900).
pub fn black_body(wavelength: f64, kelvin: f64) -> f64 {
    // Planck's constant times the speed of light over Boltzmann's constant, nm K (SI, 2019).
    const SECOND: f64 = 1.438_776_877_503_934e7;
    // Maximum of x⁵ / (eˣ − 1), where x = 5 (1 − e⁻ˣ) (Wien, 1893).
    const MOST: f64 = 21.201_435_660_549_92;
    let x = SECOND / (wavelength * kelvin);
    x.powi(5) / x.exp_m1() / MOST
}

/// Below this temperature a body's radiation is invisible.
pub const COLDEST: f64 = 500.0;

/// Highest temperature in the table.
const HOTTEST: f64 = 50_000.0;

/// Color of [`black_body`] in linear Rec. 709; negative channels are clamped to 0.
pub fn black_body_colour(kelvin: f64) -> Rgb {
    if kelvin.is_nan() || kelvin < COLDEST {
        return Rgb::ZERO;
    }
    if kelvin >= HOTTEST {
        return seen(kelvin);
    }
    let steps = (kelvin / COLDEST).ln() / *STEP;
    let before = (steps as usize).min(COLOURS.len() - 2);
    // Linear in the temperature between two entries.
    let [from, to] = [before, before + 1].map(|step| COLDEST * (step as f64 * *STEP).exp());
    let share = ((kelvin - from) / (to - from)).clamp(0.0, 1.0);
    COLOURS[before] * (1.0 - share) + COLOURS[before + 1] * share
}

/// Like `Blackbody` of the Python package: linear between every fifth nm.
fn seen(kelvin: f64) -> Rgb {
    RESPONSE.seen(|wavelength| black_body(wavelength, kelvin)).at_least(Rgb::ZERO)
}

static RESPONSE: LazyLock<Response> = LazyLock::new(|| Response::new(Illuminant::Even, 5));

/// Number of temperatures, in geometric progression. Interpolation has an error below 10⁻⁴, and 10⁻⁵ at the
/// temperatures of flames.
const COUNT: usize = 8192;

static STEP: LazyLock<f64> = LazyLock::new(|| (HOTTEST / COLDEST).ln() / COUNT as f64);

static COLOURS: LazyLock<Vec<Rgb>> =
    LazyLock::new(|| (0..=COUNT).map(|step| seen(COLDEST * (step as f64 * *STEP).exp())).collect());

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_most_is_where_wien_has_it() {
        for kelvin in [600.0, 3000.0, 6500.0, 20_000.0] {
            let peak = 2.897_771_955e6 / kelvin;
            assert!((black_body(peak, kelvin) - 1.0).abs() < 1e-12, "{kelvin}");
            assert!(black_body(peak * 0.99, kelvin) < 1.0 && black_body(peak * 1.01, kelvin) < 1.0);
        }
        // The CIE's illuminant A is 2848 K by the constant of 1931: 1.435 for 1.4388 cm K.
        for (wavelength, power) in [(400.0, 14.708), (550.0, 92.912), (700.0, 198.261)] {
            let ratio = black_body(wavelength, 2855.542) / black_body(560.0, 2855.542);
            assert!((100.0 * ratio / power - 1.0).abs() < 1e-4, "{ratio}");
        }
    }

    #[test]
    fn colours_between_those_of_the_table_are_theirs() {
        for i in 0..2000 {
            let kelvin = 501.0 * (f64::from(i) * 0.002_3).exp();
            let (found, truth) = (black_body_colour(kelvin), seen(kelvin));
            assert!((found - truth).abs().max() <= 1e-4 * truth.max(), "{kelvin}: {found} {truth}");
            if kelvin > 1500.0 {
                assert!((found - truth).abs().max() <= 1.5e-5 * truth.max(), "{kelvin}: {found} {truth}");
            }
        }
        assert_eq!(black_body_colour(499.0), Rgb::ZERO);
        assert_eq!(black_body_colour(f64::NAN), Rgb::ZERO);
        assert!(black_body_colour(60_000.0).is_radiance());
    }
}
