//! Plastic, glaze, varnish.

use super::checks::{number, within};
use super::{Material, Roughness, Scattering};
use crate::optics::{Bsdf, Coated};
use crate::scene::ShadingPoint;
use crate::scene::textures::{Needs, TexturePoint, Value};

/// Something matt under a clear coat, smooth or rough. Both sides are alike.
#[derive(Clone, Debug)]
pub struct PlasticMaterial {
    /// The share of the light that reaches what is under the coat and leaves it again, 0 to 1 in each channel.
    pub reflectance: Value,
    /// The coat's index of refraction, at least 1; where what is around has a greater one, there is no coat to be seen.
    pub ior: f64,
    /// How rough the coat is, alike in all directions.
    pub roughness: Roughness,
}

impl PlasticMaterial {
    fn bsdf(&self, point: &TexturePoint, outside: f64) -> Coated {
        let [alpha, _] = self.roughness.alpha(point);
        Coated::new(self.reflectance.at(point), (self.ior / outside).max(1.0), alpha)
    }
}

impl Material for PlasticMaterial {
    fn scattering(&self, at: &ShadingPoint) -> Scattering {
        self.bsdf(&at.texture, at.outside).into()
    }

    fn constant(&self) -> Option<Bsdf> {
        (!self.needs().any()).then(|| self.bsdf(&TexturePoint::default(), 1.0).into())
    }

    fn needs(&self) -> Needs {
        self.reflectance.needs() | self.roughness.needs()
    }

    fn validate(&self) -> Result<(), String> {
        within("reflectance", &self.reflectance, 0.0, 1.0)?;
        number("ior", self.ior, 1.0, f64::MAX)?;
        self.roughness.validate_alike()
    }
}
