//! Amounts of light.

use glam::DVec3;

/// Linear Rec. 709 red, green and blue: radiance, reflectance or throughput, by context.
pub type Rgb = DVec3;

/// The CIE luminance of linear Rec. 709.
#[inline]
pub fn luminance(rgb: Rgb) -> f64 {
    rgb.dot(DVec3::new(0.212_639, 0.715_169, 0.072_192))
}

/// Whether this can be an amount of light: finite and not negative in any channel.
#[inline]
pub fn is_radiance(rgb: Rgb) -> bool {
    rgb.is_finite() && rgb.cmpge(DVec3::ZERO).all()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_has_luminance_one() {
        assert!((luminance(Rgb::ONE) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn light_is_finite_and_not_negative() {
        assert!(is_radiance(Rgb::new(0.0, -0.0, f64::MAX)));
        for bad in [f64::NAN, f64::INFINITY, -1e-300] {
            assert!(!is_radiance(Rgb::new(1.0, bad, 1.0)));
        }
    }
}
