//! The thin dielectric material.

use super::checks::number;
use super::{BsdfMix, Material};
use crate::ShadingPoint;
use crate::media::Medium;
use crate::textures::Needs;
use raywright_optics::{AnyBsdf, Mirror, Rgb, ThinDielectric};
use std::sync::Arc;

/// A clear sheet too thin to displace refracted rays: a window, a soap bubble without interference colors.
#[derive(Clone, Debug)]
pub struct ThinDielectricMaterial {
    /// Index of refraction of the sheet.
    pub ior: f64,
    /// Enclosed medium and its priority, such as smoke in a flask; `None` if there is none.
    pub within: Option<(Arc<dyn Medium>, i32)>,
}

impl Material for ThinDielectricMaterial {
    fn bsdf(&self, at: &ShadingPoint) -> BsdfMix {
        match self.within {
            None => ThinDielectric::new(self.ior / at.outside).into(),
            // The straight part is handled separately ([`Material::straight`]), so only the reflected part remains.
            Some(_) => Mirror { reflectance: Rgb::ONE }.into(),
        }
    }

    fn constant(&self) -> Option<AnyBsdf> {
        self.within.is_none().then(|| ThinDielectric::new(self.ior).into())
    }

    fn needs(&self) -> Needs {
        Needs::NONE
    }

    fn validate(&self) -> Result<(), String> {
        number("ior", self.ior, f64::MIN_POSITIVE, f64::MAX)
    }

    fn minds_outside(&self) -> bool {
        true
    }

    fn transmits(&self) -> bool {
        true
    }

    fn medium(&self) -> Option<&Arc<dyn Medium>> {
        self.within.as_ref().map(|(medium, _)| medium)
    }

    fn straight(&self, cosine: f64, outside: f64) -> f64 {
        if self.within.is_none() { 0.0 } else { 1.0 - ThinDielectric::new(self.ior / outside).reflectance(cosine) }
    }

    fn boundary(&self) -> Option<i32> {
        self.within.as_ref().map(|(_, priority)| *priority)
    }
}
