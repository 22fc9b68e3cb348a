//! Phong's model.

use super::checks::within;
use super::{BsdfMix, Material};
use crate::ShadingPoint;
use crate::textures::{Needs, TexturePoint, Value};
use raywright_optics::{AnyBsdf, Phong, Rgb};

/// A matt surface with highlights about the mirror direction, on both sides.
#[derive(Clone, Debug)]
pub struct PhongMaterial {
    /// The share of light that is reflected diffusely, 0 to 1 in each channel.
    pub diffuse: Value,
    /// The share that makes highlights, 0 to 1; with the other at most 1.
    pub specular: Value,
    /// The power of the cosine, not negative.
    pub exponent: Value<f64>,
    /// The share of ambient light that is reflected, for integrators that know one.
    pub ambient: Value,
}

/// Whether two shares may stand beside each other. Where both are the same everywhere they add up to no more than 1.
///
/// # Errors
/// What is wrong with them.
pub(super) fn shares(diffuse: &Value, specular: &Value, exponent: &Value<f64>, ambient: &Value) -> Result<(), String> {
    within("diffuse", diffuse, 0.0, 1.0)?;
    within("specular", specular, 0.0, 1.0)?;
    within("exponent", exponent, 0.0, f64::MAX)?;
    within("ambient", ambient, 0.0, f64::MAX)?;
    match (diffuse, specular) {
        // Sums of shares such as 0.9 and 0.1 may be rounded up.
        (Value::Constant(d), Value::Constant(s)) if (*d + *s).max() > 1.0 + 1e-12 => {
            Err(format!("diffuse and specular must add up to at most 1, got {}", *d + *s))
        }
        _ => Ok(()),
    }
}

/// The classic shares at a point. Where textures say more than 1 together, highlights leave the rest to what is
/// diffuse.
pub(super) fn parts(point: &TexturePoint, diffuse: &Value, specular: &Value) -> (Rgb, Rgb) {
    let specular = specular.at(point);
    (diffuse.at(point).at_most(Rgb::ONE - specular), specular)
}

impl PhongMaterial {
    fn bsdf(&self, point: &TexturePoint) -> Phong {
        let (diffuse, specular) = parts(point, &self.diffuse, &self.specular);
        Phong::new(diffuse, specular, self.exponent.at(point))
    }
}

impl Material for PhongMaterial {
    fn bsdf(&self, at: &ShadingPoint) -> BsdfMix {
        self.bsdf(&at.texture).into()
    }

    fn constant(&self) -> Option<AnyBsdf> {
        (!self.needs().any()).then(|| self.bsdf(&TexturePoint::default()).into())
    }

    fn kinds(&self) -> Option<[usize; 2]> {
        Some([AnyBsdf::from(self.bsdf(&TexturePoint::default())).kind(); 2])
    }

    fn needs(&self) -> Needs {
        self.diffuse.needs() | self.specular.needs() | self.exponent.needs() | self.ambient.needs()
    }

    fn validate(&self) -> Result<(), String> {
        shares(&self.diffuse, &self.specular, &self.exponent, &self.ambient)
    }

    fn ambient(&self, at: &ShadingPoint) -> Rgb {
        self.ambient.at(&at.texture)
    }
}
