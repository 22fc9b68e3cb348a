//! The classic model of light.

use crate::optics::Rgb;

/// What a surface does to light in the model of Phong ("Illumination for Computer Generated Pictures", 1975) and Whitted ("An Improved
/// Illumination Model for Shaded Display", 1980): an even light from nowhere, what comes from lamps, and their highlights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Classic {
    /// The share of ambient light that is reflected.
    pub ambient: Rgb,
    /// The share of lamps' light that is reflected diffusely.
    pub diffuse: Rgb,
    /// The share that makes highlights.
    pub specular: Rgb,
    /// How sharp these are: the power of a cosine.
    pub exponent: f64,
}

impl Classic {
    /// Of what is matt, and reflects ambient light as it does any.
    pub fn matt(reflectance: Rgb) -> Self {
        Self { ambient: reflectance, diffuse: reflectance, specular: Rgb::ZERO, exponent: 1.0 }
    }

    /// Two of them in these shares; highlights are as sharp as those of the one that has more of them.
    pub fn mixed(a: (f64, Self), b: (f64, Self)) -> Self {
        let ((s, x), (t, y)) = (a, b);
        let of_x = s * x.specular.max_element() >= t * y.specular.max_element();
        Self {
            ambient: x.ambient * s + y.ambient * t,
            diffuse: x.diffuse * s + y.diffuse * t,
            specular: x.specular * s + y.specular * t,
            exponent: if of_x { x.exponent } else { y.exponent },
        }
    }
}
