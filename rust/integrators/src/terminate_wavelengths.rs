//! Dispersion: termination of secondary wavelengths.

use raywright_base::math::DVec3;
use raywright_optics::spectra::Waves;
use raywright_optics::{Bsdf, Dispersive, Rgb, fresnel};
use raywright_scene::materials::Material;

/// Dispersion at a surface. Refracted light has a direction per wavelength, so all but the hero are terminated.
/// Specular reflection keeps its direction, and all continue.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parting {
    /// Relative index of refraction of each wavelength, beyond over before the surface, if all transmitted light is
    /// refracted.
    etas: Option<Rgb>,
}

impl Parting {
    /// Return the dispersion at a surface of a material, if any, and the hero's index of refraction outside the object.
    /// `outside` is that index for yellow light, and `around` its dispersion.
    pub fn at(
        material: &dyn Material,
        is_front: bool,
        (outside, around): (f64, Dispersive),
        waves: &Waves,
    ) -> (f64, Option<Self>) {
        let Some(interior) = material.interior() else {
            // Open surfaces have the same surroundings on both sides, with an index per wavelength.
            if !(around.is_any() && material.minds_outside()) {
                return (outside, None);
            }
            return (around.at(waves.hero()).unwrap_or(outside), Some(Self { etas: None }));
        };
        if !(around.is_any() || interior.dispersion.is_any()) {
            return (outside, None);
        }
        let out = waves.lanes(|wavelength| around.at(wavelength).unwrap_or(outside));
        let eta = |within: Rgb| if is_front { within / out } else { out / within };
        let within = || waves.lanes(|wavelength| interior.dispersion.at(wavelength).unwrap_or(interior.ior));
        (out[0], Some(Self { etas: material.is_clear().then(|| eta(within())) }))
    }

    /// Return whether termination can wait for a possible specular reflection. This requires similar reflectances of
    /// all wavelengths, as those of a denser medium.
    pub fn waits(&self, bsdf: &impl Bsdf) -> bool {
        bsdf.is_delta() && self.etas.is_some_and(|etas| etas.min() > 1.0)
    }

    /// Return the factor of each wavelength after the hero was reflected specularly, along a direction of the shading
    /// frame.
    pub fn mirrored(&self, wo: DVec3) -> Rgb {
        let Some(etas) = self.etas else { return Rgb::ONE };
        let reflectance = etas.map(|eta| fresnel::dielectric(wo.z.abs().min(1.0), eta));
        if reflectance[0] > 0.0 { reflectance / reflectance[0] } else { Rgb::ONE }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_optics::{Dielectric, Dispersion};
    use raywright_scene::materials::{DielectricMaterial, DiffuseMaterial, Interior, ThinDielectricMaterial};

    #[test]
    fn mirrored_light_keeps_the_reflectance_of_each_wavelength() {
        let dispersion = Dispersive::of(Dispersion::Cauchy([1.6, 0.02])).unwrap();
        let interior = Interior { ior: 1.66, dispersion, priority: 0 };
        let glass = DielectricMaterial { interior, roughness: 0.0.into(), medium: None };
        let waves = Waves::of(0.4);
        let (outside, parting) = Parting::at(&glass, true, (1.33, Dispersive::NONE), &waves);
        let parting = parting.unwrap();
        assert_eq!(outside, 1.33);
        assert!(parting.waits(&Dielectric::new(1.2, 0.0)) && !parting.waits(&Dielectric::new(1.2, 0.3)));
        let found = parting.mirrored(DVec3::new(0.6, 0.0, 0.8));
        for lane in 0..3 {
            let of = |lane: usize| fresnel::dielectric(0.8, dispersion.at(waves.all()[lane]).unwrap() / 1.33);
            assert!((found[lane] - of(lane) / of(0)).abs() < 1e-14);
        }
        // From inside, one wavelength may be totally reflected and another hardly at all.
        let (_, within) = Parting::at(&glass, false, (1.0, Dispersive::NONE), &waves);
        assert!(!within.unwrap().waits(&Dielectric::new(0.6, 0.0)));
        // A constant index inside a dispersive medium also disperses, if the object is closed.
        let plain = DielectricMaterial { interior: Interior::new(1.2, 0), ..glass };
        let (around, parting) = Parting::at(&plain, true, (1.66, dispersion), &waves);
        assert_eq!(around, dispersion.at(waves.hero()).unwrap());
        assert!(!parting.unwrap().waits(&Dielectric::new(0.7, 0.0)));
        let (around, parting) = Parting::at(&DiffuseMaterial::default(), true, (1.0, dispersion), &waves);
        assert!(around == 1.0 && parting.is_none());
        let pane = ThinDielectricMaterial { ior: 1.5, within: None };
        let (around, parting) = Parting::at(&pane, false, (1.66, dispersion), &waves);
        assert_eq!(around, dispersion.at(waves.hero()).unwrap());
        assert!(!parting.unwrap().waits(&Dielectric::new(0.7, 0.0)));
    }
}
