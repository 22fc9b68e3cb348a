//! The primaries of Rec. 709.

use super::super::Rgb;
use super::daylight::daylight;
use super::observer::matching;
use glam::{DMat3, DVec3};
use std::sync::LazyLock;

/// Chromaticities of red, green and blue of Rec. 709 and sRGB: x, y and z, whose sum is 1 (ITU-R BT.709-6, 1.3).
const PRIMARIES: DMat3 = DMat3::from_cols_array(&[0.64, 0.33, 0.03, 0.30, 0.60, 0.10, 0.15, 0.06, 0.79]);

/// X, Y and Z of red, green and blue, as columns.
///
/// White is the tabulated daylight ([`daylight`] weighted by [`matching`]), so that white is (1, 1, 1) up to rounding.
/// The standard's white point of four digits would give (1.0000, 1.0000, 1.0003).
pub fn xyz_of_primaries() -> DMat3 {
    let mut white = DVec3::ZERO;
    for nm in 360..=830 {
        white += matching(f64::from(nm)) * daylight(f64::from(nm));
    }
    PRIMARIES * DMat3::from_diagonal(PRIMARIES.inverse() * (white / white.y))
}

/// Converts CIE X, Y and Z to linear Rec. 709, where daylight with Y = 1 is (1, 1, 1). Colors outside the gamut have a
/// negative channel, and possibly another above 1.
pub fn xyz_to_rgb(xyz: DVec3) -> Rgb {
    static MATRIX: LazyLock<DMat3> = LazyLock::new(|| xyz_of_primaries().inverse());
    Rgb::from_array((*MATRIX * xyz).to_array())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_where_the_standard_has_them() {
        // The matrix of ITU-R BT.709 as given in IEC 61966-2-1, to its four digits.
        let standard = [[0.4124, 0.2126, 0.0193], [0.3576, 0.7152, 0.1192], [0.1805, 0.0722, 0.9505]];
        let own = xyz_of_primaries();
        for (i, column) in standard.into_iter().enumerate() {
            let off = own.col(i) - DVec3::from_array(column);
            assert!(off.abs().max_element() < 4e-4, "{own}");
        }
        for channels in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0; 3]] {
            let (colour, xyz) = (Rgb::from_array(channels), own * DVec3::from_array(channels));
            assert!((xyz_to_rgb(xyz) - colour).abs().max() < 1e-14);
            assert!((colour.luminance() - xyz.y).abs() < 1e-4);
        }
    }
}
