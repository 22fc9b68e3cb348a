//! Compact storage of surface photons.

use crate::path_vertices::Arrived;
use crate::shadows::opacity;
use raywright_base::math::{DVec3, Vec3};
use raywright_optics::spectra::Waves;
use raywright_optics::{Bsdf, Rgb};
use raywright_scene::{Interaction, SurfaceInteraction};

/// A photon at a matte surface, in compact form.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StoredPhoton {
    pub position: DVec3,
    /// Unit direction of propagation.
    pub direction: Vec3,
    /// Unit geometric normal on the side of incidence.
    pub normal: Vec3,
    power: [f32; 3],
    /// Remaining share for camera paths with a reflectance above 1 on the way ([`Bsdf::repeat_correction`]).
    again: [f32; 3],
    /// Number of previous surface bounces.
    pub bounces: u32,
    /// True if only the hero wavelength is left.
    single: bool,
}

/// Minimum cosine between the normals of surfaces that share photons.
pub(super) const SAME_SIDE: f64 = 0.5;

/// Flattening of the lookup ball: distance from the surface's plane counts this many times (Jensen 2001), which rejects
/// photons of other surfaces.
pub(super) const FLAT: f64 = 4.0;

impl StoredPhoton {
    pub fn new(position: DVec3, direction: DVec3, normal: DVec3, power: Rgb, bounces: u32) -> Self {
        let power = power.to_array().map(|x| x as f32);
        let (again, single) = ([1.0; 3], false);
        Self { position, direction: direction.as_vec3(), normal: normal.as_vec3(), power, again, bounces, single }
    }

    /// Store the photon of a light path at a surface. `bounces` counts the earlier surfaces, and `single` says that the
    /// power is of the hero wavelength alone. `repeat_correction` is the remaining share for camera paths with a
    /// reflectance above 1.
    pub fn arrived(arrived: &Arrived, (power, single): (Rgb, bool), bounces: u32, again: Rgb) -> Self {
        let here = &arrived.here;
        // A mask lets light pass that is as likely to be stored as it is opaque.
        let power = power / opacity(arrived.scene, &arrived.ray, &arrived.hit);
        let photon = Self::new(here.position(), arrived.ray.direction, here.normal(), power, bounces);
        // If this surface's own reflectance exceeds 1, the camera path applies its factor.
        let own = here.bsdf().repeat_correction() != Rgb::ONE;
        let again = if own { Rgb::ONE } else { again };
        Self { again: again.to_array().map(|x| x as f32), single, ..photon }
    }

    /// Return the flux, W. `has_gamut_excess` is for camera paths with a reflectance above 1, and `single` for those
    /// that terminated all wavelengths but the hero.
    pub fn power(&self, has_gamut_excess: bool, single: bool) -> Rgb {
        let power = Rgb::from_array(self.power.map(f64::from));
        let power = if single && self.single { Waves::joined(power) } else { power };
        if has_gamut_excess { power * Rgb::from_array(self.again.map(f64::from)) } else { power }
    }

    /// Return the flattened squared distance from a point, given the Euclidean one. Return `None` if the photon is on
    /// another side of a surface or has more than `bounces` bounces.
    #[inline]
    pub fn measured<B: Bsdf>(&self, here: &SurfaceInteraction<B>, squared: f64, bounces: Option<u32>) -> Option<f64> {
        let normal = here.normal();
        let counts = bounces.is_none_or(|most| self.bounces <= most)
            && self.normal.as_dvec3().dot(normal) > SAME_SIDE
            && self.direction.as_dvec3().dot(normal) < 0.0;
        let off = (self.position - here.position()).dot(normal);
        counts.then_some(squared + (FLAT * FLAT - 1.0) * off * off)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_gilded_counts_once() {
        let photon = StoredPhoton::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Z, Rgb::splat(2.0), 1);
        assert_eq!(photon.power(true, false), photon.power(false, true));
        let has_gamut_excess = StoredPhoton { again: [0.5, 1.0, 1.0], ..photon };
        assert_eq!(has_gamut_excess.power(true, false), Rgb::new(1.0, 2.0, 2.0));
        assert_eq!(has_gamut_excess.power(false, false), Rgb::splat(2.0));
        let ended = StoredPhoton { power: [3.0, 0.0, 0.0], single: true, ..photon };
        assert_eq!(ended.power(false, true) * 3.0, ended.power(false, false));
    }
}
