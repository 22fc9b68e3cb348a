//! Sines and cosines of fractions of a turn, and the angle of a point.
//!
//! Directions are sampled by angles that are simple fractions of a turn. Their quadrant is exact, before any rounding,
//! and within an eighth of a turn a few terms of the Taylor series suffice. A sine for every argument takes much more
//! work.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// 1/3!, −1/5! and so on: the coefficients of the sine of x after x, in powers of −x². The first omitted term is
/// 5·10⁻¹⁷ at π/4.
const SINE: [f64; 7] = [
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
];

/// The same for the cosine, after 1 − x²/2. The first omitted term is 2·10⁻¹⁸ at π/4.
const COSINE: [f64; 7] = [
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40_320.0,
    -1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    -1.0 / 87_178_291_200.0,
    1.0 / 20_922_789_888_000.0,
];

/// The coefficients of the arc tangent of x after x, in powers of x²: the minimax polynomial up to tan² π/8, with an
/// error of 4·10⁻¹⁷.
const ARC: [f64; 11] = [
    -0.333_333_333_333_333_3,
    0.199_999_999_999_955_2,
    -0.142_857_142_846_665_42,
    0.111_111_110_152_563_61,
    -0.090_909_045_781_239_03,
    0.076_921_831_908_260_87,
    -0.066_645_114_473_819_48,
    0.058_581_489_128_022_1,
    -0.050_854_497_379_402_6,
    0.039_231_658_295_587_19,
    -0.019_176_887_119_066_22,
];

/// A polynomial of degree 6, with terms in pairs for instruction-level parallelism (Estrin, 1960).
#[inline(always)]
fn polynomial(c: &[f64; 7], z: f64) -> f64 {
    let (z2, z4) = (z * z, (z * z) * (z * z));
    (c[0] + c[1] * z) + (c[2] + c[3] * z) * z2 + ((c[4] + c[5] * z) + c[6] * z2) * z4
}

/// The sine and the cosine of an angle between −π/4 and π/4, to within 2⁻⁵² of 1.
#[inline(always)]
pub fn sin_cos_eighth(x: f64) -> [f64; 2] {
    let z = x * x;
    [x + x * z * polynomial(&SINE, z), 1.0 - 0.5 * z + z * z * polynomial(&COSINE, z)]
}

/// Rotate by a number of quarter turns.
#[inline(always)]
fn turned([sin, cos]: [f64; 2], quarters: i32) -> [f64; 2] {
    let [sin, cos] = if quarters & 1 == 0 { [sin, cos] } else { [cos, -sin] };
    if quarters & 2 == 0 { [sin, cos] } else { [-sin, -cos] }
}

/// The sine and the cosine of a fraction of a turn, from 0 to 1, to within 2⁻⁵¹ of 1.
#[inline(always)]
pub fn sin_cos_turn(part: f64) -> [f64; 2] {
    let quarters = (4.0 * part + 0.5) as i32;
    // Exact, as a difference of nearby numbers.
    let rest = part - 0.25 * f64::from(quarters);
    turned(sin_cos_eighth(TAU * rest), quarters)
}

/// The sine and the cosine of an angle from 0 to 2π, to within 2⁻⁵¹ of 1.
#[inline(always)]
pub fn sin_cos(angle: f64) -> [f64; 2] {
    /// π/2 in two parts, the first with so few digits that its multiples are exact.
    const QUARTER: [f64; 2] = [f64::from_bits(0x3FF9_21FB_5400_0000), 9.920_935_796_805_404e-10];
    let quarters = (angle * FRAC_2_PI + 0.5) as i32;
    let rest = (angle - f64::from(quarters) * QUARTER[0]) - f64::from(quarters) * QUARTER[1];
    turned(sin_cos_eighth(rest), quarters)
}

/// The angle of a point in the upper half-plane from +x, from 0 to π, to a relative error of 2⁻⁵⁰; 0 at the origin.
#[inline(always)]
pub fn upper_angle(y: f64, x: f64) -> f64 {
    /// tan π/8, and its inverse.
    const EIGHTH: [f64; 2] = [0.414_213_562_373_095_03, 2.414_213_562_373_095];
    let width = x.abs();
    // Rotated by a quarter or an eighth of a turn, so that it is within a sixteenth of a turn from an axis.
    let (is_steep, is_flat) = (y > EIGHTH[1] * width, y <= EIGHTH[0] * width);
    let (over, under) = if is_steep { (-width, y) } else { (y - width, y + width) };
    let (over, under) = if is_flat { (y, width) } else { (over, under) };
    let turn = if is_steep { FRAC_PI_2 } else { FRAC_PI_4 };
    let turn = if is_flat { 0.0 } else { turn };
    let tangent = if under > 0.0 { over / under } else { 0.0 };
    let z = tangent * tangent;
    let (z2, z4) = (z * z, (z * z) * (z * z));
    let low = (ARC[0] + ARC[1] * z) + (ARC[2] + ARC[3] * z) * z2;
    let middle = (ARC[4] + ARC[5] * z) + (ARC[6] + ARC[7] * z) * z2;
    let high = (ARC[8] + ARC[9] * z) + ARC[10] * z2;
    let angle = turn + (tangent + tangent * (z * (low + (middle + high * z4) * z4)));
    if x < 0.0 { PI - angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_4, PI};

    #[test]
    fn exact_where_the_truth_is() {
        assert_eq!(sin_cos_eighth(0.0), [0.0, 1.0]);
        assert_eq!(sin_cos_turn(0.0), [0.0, 1.0]);
        assert_eq!(sin_cos_turn(0.25), [1.0, 0.0]);
        assert_eq!(sin_cos_turn(0.5), [0.0, -1.0]);
        assert_eq!(sin_cos_turn(0.75), [-1.0, 0.0]);
        assert_eq!(sin_cos_turn(1.0), [0.0, 1.0]);
        for eighth in [1, 3, 5, 7] {
            let [sin, cos] = sin_cos_turn(f64::from(eighth) / 8.0);
            assert!((sin.abs() - FRAC_1_SQRT_2).abs() < 2e-16 && (cos.abs() - FRAC_1_SQRT_2).abs() < 2e-16);
            assert_eq!((sin > 0.0, cos > 0.0), (eighth < 4, !(2..6).contains(&eighth)));
        }
        // sin² 22.5° = (2 − √2) / 4.
        let [sin, cos] = sin_cos_eighth(PI / 8.0);
        assert!((sin * sin - (2.0 - 2f64.sqrt()) / 4.0).abs() < 1e-16 && (sin * sin + cos * cos - 1.0).abs() < 3e-16);
    }

    #[test]
    fn angles_are_exact_on_the_axes_and_between() {
        assert_eq!(
            [(0.0, 3.0), (0.0, 0.0), (5.0, 0.0), (0.0, -2.0)].map(|(y, x)| upper_angle(y, x)),
            [0.0, 0.0, FRAC_PI_2, PI]
        );
        assert_eq!([(2.0, 2.0), (7.0, -7.0)].map(|(y, x)| upper_angle(y, x)), [FRAC_PI_4, PI - FRAC_PI_4]);
    }

    proptest! {
        #[test]
        fn angles_as_libm_has_them(y in -280.0..280.0f64, ratio in -25.0..25.0f64, negative: bool) {
            let (y, x) = (10f64.powf(y), 10f64.powf(y - ratio));
            let x = if negative { -x } else { x };
            let [angle, wanted] = [upper_angle(y, x), y.atan2(x)];
            prop_assert!((angle - wanted).abs() <= 4.0 * f64::EPSILON * wanted, "{y} {x}: {angle}, not {wanted}");
        }

        #[test]
        fn as_libm_has_them(part in 0.0..=1.0f64) {
            let close = |[sin, cos]: [f64; 2], angle: f64, within: f64| {
                prop_assert!((sin - angle.sin()).abs() <= within && (cos - angle.cos()).abs() <= within, "{angle}");
                Ok(())
            };
            close(sin_cos_eighth((part - 0.5) * FRAC_PI_4 * 2.0), (part - 0.5) * FRAC_PI_4 * 2.0, f64::EPSILON)?;
            close(sin_cos(TAU * part), TAU * part, 2.0 * f64::EPSILON)?;
            // libm's argument is rounded, by as much as 4 ε.
            close(sin_cos_turn(part), TAU * part, 6.0 * f64::EPSILON)?;
        }

        #[test]
        fn small_ones_keep_their_digits(exponent in -300.0..-1.0f64) {
            let x = 10f64.powf(exponent);
            prop_assert!((sin_cos_eighth(x)[0] / x.sin() - 1.0).abs() <= f64::EPSILON);
            prop_assert!((sin_cos_turn(x)[0] / (TAU * x).sin() - 1.0).abs() <= 4.0 * f64::EPSILON);
        }
    }
}
