//! A free film.

use super::bsdf::either;
use super::bsdf_columns::LaneBsdf;
use super::filmed::Filmed;
use super::mirror::mirrored;
use super::scalar_lanes::Looped;
use super::spectra::Waves;
use super::{Bsdf, BsdfSample, Rgb};
use glam::DVec3;

/// A film with the same medium on both sides. It reflects in interference colors and transmits the rest straight.
#[derive(Clone, Copy, Debug)]
pub struct SoapFilm {
    film: Filmed,
}

impl SoapFilm {
    /// Creates a film from a thickness in nm and the indices of refraction of film and surroundings, at some
    /// wavelengths, or for red, green and blue.
    pub fn new(thickness: f64, film: f64, around: f64, waves: Option<Waves>) -> Self {
        Self { film: Filmed::new(thickness, [around, film, around]).at(waves) }
    }

    /// Reflectance along `w`.
    #[inline]
    pub fn reflectance(&self, w: DVec3) -> Rgb {
        self.film.reflectance(w.z.abs(), true)
    }
}

impl Bsdf for SoapFilm {
    #[inline(always)]
    fn evaluate(&self, _wo: DVec3, _wi: DVec3) -> (Rgb, f64) {
        (Rgb::ZERO, 0.0)
    }

    #[inline(always)]
    fn sample(&self, wo: DVec3, choice: &mut dyn FnMut() -> f64, _u: [f64; 2]) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let reflectance = self.reflectance(wo);
        let chance = reflectance.mean();
        let is_reflected = choice() < chance;
        let drawn = if is_reflected {
            BsdfSample::delta(mirrored(wo), reflectance / chance)
        } else {
            BsdfSample::delta(-wo, (Rgb::ONE - reflectance) / (1.0 - chance)).through(1.0)
        };
        Some(drawn.of_lobe(either(chance, is_reflected)))
    }

    fn albedo(&self) -> Rgb {
        Rgb::ONE
    }

    fn is_delta(&self) -> bool {
        true
    }

    fn transmits(&self) -> bool {
        true
    }

    fn roughness(&self) -> f64 {
        0.0
    }
}

impl LaneBsdf for SoapFilm {
    type Lanes = Looped;
}
