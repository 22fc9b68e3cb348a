//! The CIE standard illuminant D65.

use super::{FIRST, LAST, matching};
use std::sync::LazyLock;

/// Power of daylight at a wavelength, relative to 100 at 560 nm: the CIE's standard illuminant D65 (CIE 015:2018),
/// linear between every tenth nm, as defined. Zero outside the visible range.
#[inline]
pub fn daylight(wavelength: f64) -> f64 {
    if !(FIRST..=LAST).contains(&wavelength) {
        return 0.0;
    }
    let steps = (wavelength - FIRST) / STEP;
    let before = (steps as usize).min(POWER.len() - 2);
    POWER[before] + (POWER[before + 1] - POWER[before]) * (steps - before as f64)
}

/// Daylight normalized to luminance 1, which is that of light with power 1 at all wavelengths.
#[inline]
pub fn white(wavelength: f64) -> f64 {
    daylight(wavelength) / *MEAN
}

/// Mean power of daylight, weighted by the luminous efficiency.
static MEAN: LazyLock<f64> = LazyLock::new(|| {
    let (mut sum, mut all) = (0.0, 0.0);
    for nm in (360..=830).map(f64::from) {
        let weight = matching(nm).y;
        sum += weight * daylight(nm);
        all += weight;
    }
    sum / all
});

const STEP: f64 = 10.0;

#[rustfmt::skip]
const POWER: [f64; 48] = [
    46.6383, 52.0891, 49.9755, 54.6482, 82.7549, 91.486, 93.4318, 86.6823, 104.865, 117.008, 117.812, 114.861, 115.923,
    108.811, 109.354, 107.802, 104.79, 107.689, 104.405, 104.046, 100.0, 96.3342, 95.788, 88.6856, 90.0062, 89.5991,
    87.6987, 83.2886, 83.6992, 80.0268, 80.2146, 82.2778, 78.2842, 69.7213, 71.6091, 74.349, 61.604, 69.8856, 75.087,
    63.5927, 46.4182, 66.8054, 63.3828, 64.304, 59.4519, 51.959, 57.4406, 60.3125,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_stand_where_they_belong() {
        for (wavelength, power) in [(360.0, 46.6383), (560.0, 100.0), (565.0, 98.1671), (830.0, 60.3125)] {
            assert!((daylight(wavelength) - power).abs() < 1e-4);
        }
        assert_eq!([359.9, 830.1, f64::NAN].map(daylight), [0.0; 3]);
    }
}
