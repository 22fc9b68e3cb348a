//! Compact storage of photons in media.

use super::photon_lookup::Places;
use crate::media::current_medium::Filled;
use crate::media::scattering::Scattering;
use crate::nesting::MediumStack;
use raywright_base::math::{DVec3, Vec3};
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;

/// A photon scattered in a medium, in compact form.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VolumePhoton {
    pub position: DVec3,
    /// Unit direction of propagation.
    pub direction: Vec3,
    /// Flux over the extinction at the photon, W times a length. Divided by a volume it is fluence.
    power: [f32; 3],
    /// Remaining share for camera paths with a reflectance above 1, as in surface photons.
    again: [f32; 3],
    /// Number of previous scattering events.
    bounces: u32,
    /// Medium of the photon.
    filled: (u32, u32),
    /// True if the power is of the hero wavelength alone.
    single: bool,
}

impl VolumePhoton {
    /// Make a photon of a given power; `single` says that it is of the hero wavelength alone.
    pub fn new(
        here: &Scattering,
        (power, single): (Rgb, bool),
        again: Rgb,
        bounces: u32,
        media: &MediumStack<Filled>,
    ) -> Self {
        let [power, again] = [power, again].map(|rgb| rgb.to_array().map(|x| x as f32));
        let direction = here.before.as_vec3();
        Self { position: here.position, direction, power, again, bounces, filled: Filled::there(media), single }
    }

    /// Return whether the photon is in the same medium and has at most `bounces` scattering events.
    #[inline]
    pub fn counts(&self, filled: (u32, u32), bounces: Option<u32>) -> bool {
        self.filled == filled && bounces.is_none_or(|most| self.bounces <= most)
    }

    /// Return the power. `has_gamut_excess` is for camera paths with a reflectance above 1, and `single` for those that
    /// terminated all wavelengths but the hero.
    pub fn power(&self, has_gamut_excess: bool, single: bool) -> Rgb {
        let power = Rgb::from_array(self.power.map(f64::from));
        let power = if single && self.single { Waves::joined(power) } else { power };
        if has_gamut_excess { power * Rgb::from_array(self.again.map(f64::from)) } else { power }
    }
}

/// Photons in media with their lookup structure.
#[derive(Debug)]
pub(crate) struct VolumeIndex {
    pub photons: Vec<VolumePhoton>,
    pub places: Places,
}

impl VolumeIndex {
    /// Build a lookup structure for a given radius, or for nearest neighbors.
    pub fn new(photons: Vec<VolumePhoton>, radius: Option<f64>) -> Self {
        let places = Places::new(photons.iter().map(|photon| photon.position), radius);
        Self { photons, places }
    }
}
