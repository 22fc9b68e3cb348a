//! The Phong material.

use super::checks::within;
use super::{BsdfMix, Material};
use crate::ShadingPoint;
use crate::textures::{Needs, TexturePoint, Value};
use raywright_optics::{AnyBsdf, Phong, Rgb};

/// A diffuse surface with highlights around the mirror direction, on both sides.
#[derive(Clone, Debug)]
pub struct PhongMaterial {
    /// Diffuse reflectance, 0 to 1 in each channel.
    pub diffuse: Value,
    /// Specular reflectance, 0 to 1; the sum with the diffuse one is at most 1.
    pub specular: Value,
    /// Exponent of the cosine, not negative.
    pub exponent: Value<f64>,
    /// Ambient reflectance, for integrators with ambient light.
    pub ambient: Value,
}

/// Checks the ranges of the parameters, and that constant reflectances add up to at most 1.
///
/// # Errors
/// A message about the first invalid parameter.
pub(super) fn shares(diffuse: &Value, specular: &Value, exponent: &Value<f64>, ambient: &Value) -> Result<(), String> {
    within("diffuse", diffuse, 0.0, 1.0)?;
    within("specular", specular, 0.0, 1.0)?;
    within("exponent", exponent, 0.0, f64::MAX)?;
    within("ambient", ambient, 0.0, f64::MAX)?;
    match (diffuse, specular) {
        // A sum of reflectances such as 0.9 and 0.1 may be rounded up.
        (Value::Constant(d), Value::Constant(s)) if (*d + *s).max() > 1.0 + 1e-12 => {
            Err(format!("diffuse and specular must add up to at most 1, got {}", *d + *s))
        }
        _ => Ok(()),
    }
}

/// Diffuse and specular reflectance at a point. If textures add up to more than 1, the diffuse one is reduced.
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
