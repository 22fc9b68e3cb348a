//! Daylight after sunset.

use std::f64::consts::PI;

/// End of twilight, degrees below the horizon.
const NIGHT: f64 = 18.0;

/// Illuminance of level ground under a clear sky: its base-10 logarithm, in lux, as polynomials of the sun's elevation
/// over 90°. Each piece applies above its first number (Seidelmann, "Explanatory Supplement to the Astronomical
/// Almanac", 1992, with 2.70 and 13.84: two more digits make the pieces meet).
const PIECES: [(f64, [f64; 4]); 3] = [
    (-5.0, [2.88, 21.81, -258.11, -858.36]),
    (-12.0, [2.7016, 12.17, -431.69, -1899.83]),
    (-NIGHT, [13.8373, 262.72, 1447.42, 2797.93]),
];

/// Base-10 logarithm of the illuminance in lux, for a sun at an elevation in degrees from −18 to 0.
fn illuminance(degrees: f64) -> f64 {
    let x = degrees / 90.0;
    let (_, [a, b, c, d]) = PIECES.into_iter().find(|(above, _)| degrees > *above).unwrap_or(PIECES[2]);
    a + x * (b + x * (c + x * d))
}

/// Light of the sky relative to that with the sun at the horizon, by the cosine of the sun's zenith angle. It is 1
/// above the horizon, and 0 below −18°, where starlight and airglow would be brighter.
pub fn share(cos_zenith: f64) -> f64 {
    let degrees = cos_zenith.clamp(-1.0, 1.0).asin() * 180.0 / PI;
    if degrees >= 0.0 {
        1.0
    } else if degrees <= -NIGHT {
        0.0
    } else {
        10f64.powf(illuminance(degrees) - illuminance(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::{NIGHT, PIECES, illuminance, share};

    #[test]
    fn the_ends_of_twilights_are_as_dark_as_almanacs_have_them() {
        // Civil, nautical and astronomical twilight, in lux.
        for (degrees, lux) in [(-6.0, 3.4), (-12.0, 0.008), (-18.0, 0.00065)] {
            let told = 10f64.powf(illuminance(degrees));
            assert!((told / lux - 1.0).abs() < 0.02, "{degrees}: {told}");
        }
    }

    #[test]
    fn twilight_falls_without_a_step() {
        for (degrees, _) in &PIECES[..2] {
            let step = illuminance(degrees + 1e-9) - illuminance(degrees - 1e-9);
            assert!(step.abs() < 1e-4, "{degrees}: {step}");
        }
        let at = |degrees: f64| share(degrees.to_radians().sin());
        let all: Vec<f64> = (0..=400).map(|i| at(-0.05 * f64::from(i))).collect();
        assert!(all.windows(2).all(|pair| pair[1] <= pair[0]));
        assert_eq!((at(0.0), at(1e-9), at(90.0)), (1.0, 1.0, 1.0));
        assert!((at(-1e-6) - 1.0).abs() < 1e-5);
        assert!(at(-NIGHT + 0.01) > 0.0);
        assert_eq!((at(-NIGHT - 1e-9), at(-90.0)), (0.0, 0.0));
    }
}
