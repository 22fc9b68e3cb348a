//! Sunlight after transmission through the atmosphere.

use raywright_optics::Rgb;
use std::f64::consts::PI;

/// Half the angular diameter of the sun, radians; the diameter is 0.53°.
pub const RADIUS: f64 = 0.265 * PI / 180.0;

/// Solid angle of the sun.
pub fn solid_angle() -> f64 {
    let sine = (0.5 * RADIUS).sin();
    4.0 * PI * sine * sine
}

/// Absorption of ozone, cm⁻¹, every 10 nm from 450 to 700 nm (Iqbal, "An Introduction to Solar Radiation", 1983, as in
/// Preetham et al.).
const OZONE: [f64; 26] = [
    0.003, 0.006, 0.009, 0.014, 0.021, 0.030, 0.040, 0.048, 0.063, 0.075, 0.085, 0.103, 0.120, 0.120, 0.115, 0.125,
    0.120, 0.105, 0.090, 0.079, 0.067, 0.057, 0.048, 0.036, 0.028, 0.023,
];

/// Thickness of the ozone layer, cm.
const OZONE_DEPTH: f64 = 0.35;

/// Radiance of a black body with a temperature in kelvin at a wavelength in nm, W·sr⁻¹·m⁻²·nm⁻¹ (Planck, 1900).
pub fn black_body(wavelength: f64, temperature: f64) -> f64 {
    const C1: f64 = 1.191_042_972e-16;
    const C2: f64 = 1.438_776_877e-2;
    let metres = wavelength * 1e-9;
    C1 / metres.powi(5) / (C2 / (metres * temperature)).exp_m1() * 1e-9
}

/// Transmittance of clear air at a wavelength in nm, by the cosine of the sun's zenith angle and a turbidity (Preetham,
/// Shirley and Smits, "A Practical Analytic Model for Daylight", 1999, appendix 2). It includes Rayleigh scattering,
/// aerosols and ozone. Water and mixed gases absorb next to no visible light.
pub fn transmittance(wavelength: f64, cos_zenith: f64, turbidity: f64) -> f64 {
    // Relative air mass (Kasten, 1966).
    let degrees = cos_zenith.clamp(0.0, 1.0).acos().to_degrees();
    let mass = 1.0 / (cos_zenith.max(0.0) + 0.15 * (93.885 - degrees).powf(-1.253));
    let micrometres = wavelength * 1e-3;
    let molecules = 0.008735 * micrometres.powf(-4.08);
    let dust = (0.04608 * turbidity - 0.04586) * micrometres.powf(-1.3);
    let place = (wavelength - 450.0) / 10.0;
    let index = (place.floor().max(0.0) as usize).min(OZONE.len() - 2);
    let ozone = if (0.0..=(OZONE.len() - 1) as f64).contains(&place) {
        let x = place - index as f64;
        (OZONE[index] * (1.0 - x) + OZONE[index + 1] * x) * OZONE_DEPTH
    } else {
        0.0
    };
    (-(molecules + dust + ozone) * mass).exp()
}

/// Color-matching functions of the CIE 1931 observer at a wavelength in nm (Wyman, Sloan and Shirley, "Simple Analytic
/// Approximations to the CIE XYZ Color Matching Functions", 2013).
pub fn observer(wavelength: f64) -> [f64; 3] {
    let lobe = |middle: f64, left: f64, right: f64| {
        let x = (wavelength - middle) / if wavelength < middle { left } else { right };
        (-0.5 * x * x).exp()
    };
    [
        1.056 * lobe(599.8, 37.9, 31.0) + 0.362 * lobe(442.0, 16.0, 26.7) - 0.065 * lobe(501.1, 20.4, 26.2),
        0.821 * lobe(568.8, 46.9, 40.5) + 0.286 * lobe(530.9, 16.3, 31.1),
        1.217 * lobe(437.0, 11.8, 36.0) + 0.681 * lobe(459.0, 26.0, 13.8),
    ]
}

/// Converts CIE XYZ to linear Rec. 709, clamped to its gamut.
pub fn from_xyz([x, y, z]: [f64; 3]) -> Rgb {
    Rgb::new(
        3.240_970 * x - 1.537_383 * y - 0.498_611 * z,
        -0.969_244 * x + 1.875_968 * y + 0.041_555 * z,
        0.055_630 * x - 0.203_977 * y + 1.056_972 * z,
    )
    .at_least(Rgb::ZERO)
}

/// Radiance of the sun seen from the ground: a black body of 5778 K through the atmosphere. Luminance over 683 lm·W⁻¹.
pub fn radiance(cos_zenith: f64, turbidity: f64) -> Rgb {
    let xyz = (360..=830).fold([0.0; 3], |mut sum, wavelength| {
        let wavelength = f64::from(wavelength);
        let light = black_body(wavelength, 5778.0) * transmittance(wavelength, cos_zenith, turbidity);
        for (sum, weight) in sum.iter_mut().zip(observer(wavelength)) {
            *sum += light * weight;
        }
        sum
    });
    from_xyz(xyz)
}
