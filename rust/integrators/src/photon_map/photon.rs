//! Photons as maps keep them.

use crate::light_paths::Arrived;
use raywright_base::math::{DVec3, Vec3};
use raywright_optics::spectra::Waves;
use raywright_optics::{Bsdf, Rgb};
use raywright_scene::{Encounter, SurfaceInteraction};

/// Light that has come to a matt surface, in as few bytes as its numbers need.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StoredPhoton {
    pub position: DVec3,
    /// The unit direction that it came along.
    pub direction: Vec3,
    /// The unit geometric normal, on the side that it came to.
    pub normal: Vec3,
    power: [f32; 3],
    /// What is left of it for a viewer who looks by way of what gives more than there is ([`Bsdf::again`]).
    again: [f32; 3],
    /// How many surfaces it has been scattered at before.
    pub bounces: u32,
    /// Whether the hero of its wavelengths is all that it has come by.
    single: bool,
}

/// The least cosine between the normals of surfaces that light is gathered from together.
pub(super) const SAME_SIDE: f64 = 0.5;

/// How much thinner than wide the place is that light is gathered from: what lies off the plane of the surface counts
/// as farther (Jensen 2001), so that photons of other surfaces are left out.
pub(super) const FLAT: f64 = 4.0;

impl StoredPhoton {
    pub fn new(position: DVec3, direction: DVec3, normal: DVec3, power: Rgb, bounces: u32) -> Self {
        let power = power.to_array().map(|x| x as f32);
        let (again, single) = ([1.0; 3], false);
        Self { position, direction: direction.as_vec3(), normal: normal.as_vec3(), power, again, bounces, single }
    }

    /// That of a path which has come to a surface, of so much flux, which may be that of the hero of its wavelengths
    /// alone, after so many others; with what is left of it for a viewer who looks by way of what gives more than there
    /// is.
    pub fn arrived(arrived: &Arrived, (power, single): (Rgb, bool), bounces: u32, again: Rgb) -> Self {
        let here = &arrived.here;
        let photon = Self::new(here.position(), arrived.ray.direction, here.normal(), power, bounces);
        // Where this very surface gives more than there is, the viewer's path knows what it leaves of it.
        let own = here.bsdf().again() != Rgb::ONE;
        let again = if own { Rgb::ONE } else { again };
        Self { again: again.to_array().map(|x| x as f32), single, ..photon }
    }

    /// The flux that it stands for, W, as a viewer sees it who looks by way of what gives more than there is, or not,
    /// and who has ended all wavelengths but the hero, or not.
    pub fn power(&self, gilded: bool, single: bool) -> Rgb {
        let power = Rgb::from_array(self.power.map(f64::from));
        let power = if single && self.single { Waves::joined(power) } else { power };
        if gilded { power * Rgb::from_array(self.again.map(f64::from)) } else { power }
    }

    /// The square of its distance from a point, told that of the straight way, if it came to the same side of a surface
    /// there and has been scattered at so many surfaces at most.
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
        let gilded = StoredPhoton { again: [0.5, 1.0, 1.0], ..photon };
        assert_eq!(gilded.power(true, false), Rgb::new(1.0, 2.0, 2.0));
        assert_eq!(gilded.power(false, false), Rgb::splat(2.0));
        let ended = StoredPhoton { power: [3.0, 0.0, 0.0], single: true, ..photon };
        assert_eq!(ended.power(false, true) * 3.0, ended.power(false, false));
    }
}
