//! A pane of glass.

use super::checks::number;
use super::{BsdfMix, Material};
use crate::ShadingPoint;
use crate::media::Medium;
use crate::textures::Needs;
use raywright_optics::{AnyBsdf, Mirror, Rgb, ThinDielectric};
use std::sync::Arc;

/// A clear sheet too thin to bend what is seen through it: a window, a soap bubble without colours.
#[derive(Clone, Debug)]
pub struct ThinDielectricMaterial {
    /// The index of refraction within the sheet.
    pub ior: f64,
    /// What it encloses, as a flask does smoke, and its priority; none where that is nothing.
    pub within: Option<(Arc<dyn Medium>, i32)>,
}

impl Material for ThinDielectricMaterial {
    fn bsdf(&self, at: &ShadingPoint) -> BsdfMix {
        match self.within {
            None => ThinDielectric::new(self.ior / at.outside).into(),
            // What does not go straight on.
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
