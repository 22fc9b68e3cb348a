//! The CIE 1931 standard observer.

use super::observer_table::RESPONSE;
use super::{FIRST, LAST};
use glam::DVec3;

/// Color-matching functions x̄, ȳ and z̄ of the CIE's standard observer of 1931, for a field of 2 degrees (CIE
/// 018:2019, table 6, every nm; linear between). Zero outside the visible range.
#[inline]
pub fn matching(wavelength: f64) -> DVec3 {
    if !(FIRST..=LAST).contains(&wavelength) {
        return DVec3::ZERO;
    }
    let steps = wavelength - FIRST;
    let before = (steps as usize).min(RESPONSE.len() - 2);
    let [a, b] = [before, before + 1].map(|i| DVec3::from_array(RESPONSE[i]));
    a + (b - a) * (steps - before as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_of_all_wavelengths_alike_is_white() {
        // Sums published by the CIE over every fifth nm from 380 to 780 (CIE 015:2018, table of the 1931 observer).
        let sum: DVec3 = (0..=80).map(|i| matching(380.0 + 5.0 * f64::from(i))).sum();
        assert!((sum - DVec3::new(21.3714, 21.3711, 21.3715)).abs().max_element() < 3e-4, "{sum}");
        // Over the whole range, x, y and z have equal sums to the precision of the table.
        let all: DVec3 = (0..95).map(|i| matching(360.0 + 5.0 * f64::from(i))).sum();
        assert!((all / all.y - DVec3::ONE).abs().max_element() < 4e-4, "{all}");
    }

    #[test]
    fn values_stand_where_they_belong() {
        // The peak of each, and the wavelength where y is 1 by definition.
        assert_eq!(matching(555.0), DVec3::new(0.51205010, 1.0, 0.005749999));
        assert_eq!(matching(600.0).x, 1.0622);
        assert_eq!(matching(445.0).z, 1.7826);
        assert_eq!(matching(601.0), DVec3::new(1.0607352, 0.6181555, 0.00076096));
        assert!((matching(600.5).x - (1.0622 + 1.0607352) / 2.0).abs() < 1e-15);
        assert_eq!([359.9, 830.1, f64::NAN].map(matching), [DVec3::ZERO; 3]);
    }
}
