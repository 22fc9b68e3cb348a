//! A model of the clear sky's radiance.

use super::sun::from_xyz;
use raywright_optics::Rgb;
use std::f64::consts::PI;

/// The sky model of Preetham, Shirley and Smits ("A Practical Analytic Model for Daylight", 1999). Luminance and
/// chromaticity relative to the zenith follow a formula of five coefficients (Perez, Seals and Michalsky, 1993) that
/// depend on the turbidity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perez {
    /// For luminance, x and y: factors from the formula to absolute values.
    scale: [f64; 3],
    coefficients: [[f64; 5]; 3],
}

/// The coefficients of luminance, x and y: slope by turbidity, and intercept.
const COEFFICIENTS: [[[f64; 2]; 5]; 3] = [
    [[0.1787, -1.4630], [-0.3554, 0.4275], [-0.0227, 5.3251], [0.1206, -2.5771], [-0.0670, 0.3703]],
    [[-0.0193, -0.2592], [-0.0665, 0.0008], [-0.0004, 0.2125], [-0.0641, -0.8989], [-0.0033, 0.0452]],
    [[-0.0167, -0.2608], [-0.0950, 0.0092], [-0.0079, 0.2102], [-0.0441, -1.6537], [-0.0109, 0.0529]],
];

/// Zenith chromaticities: rows by falling powers of the turbidity, columns by falling powers of the sun's zenith angle.
const ZENITH: [[[f64; 4]; 3]; 2] = [
    [[0.00166, -0.00375, 0.00209, 0.0], [-0.02903, 0.06377, -0.03202, 0.00394], [0.11693, -0.21196, 0.06052, 0.25886]],
    [[0.00275, -0.00610, 0.00317, 0.0], [-0.04214, 0.08970, -0.04153, 0.00516], [0.15346, -0.26756, 0.06670, 0.26688]],
];

fn formula([a, b, c, d, e]: [f64; 5], cos_zenith: f64, cos_sun: f64) -> f64 {
    let sun = cos_sun.clamp(-1.0, 1.0);
    (1.0 + a * (b / cos_zenith).exp()) * (1.0 + c * (d * sun.acos()).exp() + e * sun * sun)
}

impl Perez {
    /// Creates a sky for the cosine of the sun's zenith angle, from 0 to 1, and a turbidity from 2 to 10.
    pub fn new(cos_zenith: f64, turbidity: f64) -> Self {
        let t = turbidity;
        let angle = cos_zenith.clamp(0.0, 1.0).acos();
        let chi = (4.0 / 9.0 - t / 120.0) * (PI - 2.0 * angle);
        // In cd·m⁻², over 683 lm·W⁻¹.
        let luminance = ((4.0453 * t - 4.9710) * chi.tan() - 0.2155 * t + 2.4192) * 1000.0 / 683.0;
        let powers = [angle * angle * angle, angle * angle, angle, 1.0];
        let [x, y] = ZENITH.map(|rows| {
            let [a, b, c] = rows.map(|row| row.iter().zip(powers).map(|(k, power)| k * power).sum::<f64>());
            (a * t + b) * t + c
        });
        let coefficients = COEFFICIENTS.map(|each| each.map(|[slope, start]| slope * t + start));
        let zenith = [luminance, x, y];
        let scale = [0, 1, 2].map(|i| zenith[i] / formula(coefficients[i], 1.0, cos_zenith));
        Self { scale, coefficients }
    }

    /// Radiance from a direction, by its cosines to the zenith, above 0, and to the sun; luminance over 683 lm·W⁻¹.
    pub fn radiance(&self, cos_zenith: f64, cos_sun: f64) -> Rgb {
        // At the horizon the formula has a limit, because e^−∞ = 0.
        let cos_zenith = cos_zenith.max(1e-6);
        let [luminance, x, y] = [0, 1, 2].map(|i| self.scale[i] * formula(self.coefficients[i], cos_zenith, cos_sun));
        let luminance = luminance.max(0.0);
        from_xyz([x / y * luminance, luminance, (1.0 - x - y) / y * luminance])
    }
}
