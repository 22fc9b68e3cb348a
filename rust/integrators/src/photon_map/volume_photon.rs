//! Photons among media, as maps keep them.

use super::places::Places;
use crate::nesting::MediumStack;
use crate::volumes::{Filled, Scattering};
use raywright_base::math::{DVec3, Vec3};
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;

/// Light that a medium has scattered, in as few bytes as its numbers need.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VolumePhoton {
    pub position: DVec3,
    /// The unit direction that it came along.
    pub direction: Vec3,
    /// Flux over the extinction where it was met, W times a length: over volume, that is fluence.
    power: [f32; 3],
    /// As photons of surfaces have it.
    again: [f32; 3],
    /// How often it has been scattered before.
    bounces: u32,
    /// In what.
    filled: (u32, u32),
    /// Whether it is light of the first of its wavelengths alone, which stands for all.
    single: bool,
}

impl VolumePhoton {
    /// Of so much power, which may be that of the first of its wavelengths alone.
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

    /// Whether it counts in what fills a place, and has been scattered so many times at most.
    #[inline]
    pub fn counts(&self, filled: (u32, u32), bounces: Option<u32>) -> bool {
        self.filled == filled && bounces.is_none_or(|most| self.bounces <= most)
    }

    /// The power as a viewer sees it who looks by way of what gives more than there is, or not, and who has ended all
    /// wavelengths but the first, or not.
    pub fn power(&self, gilded: bool, single: bool) -> Rgb {
        let power = Rgb::from_array(self.power.map(f64::from));
        let power = if single && self.single { Waves::joined(power) } else { power };
        if gilded { power * Rgb::from_array(self.again.map(f64::from)) } else { power }
    }
}

/// Photons among media, and where they are found.
#[derive(Debug)]
pub(crate) struct VolumeIndex {
    pub photons: Vec<VolumePhoton>,
    pub places: Places,
}

impl VolumeIndex {
    /// For all within a radius, or for the nearest.
    pub fn new(photons: Vec<VolumePhoton>, radius: Option<f64>) -> Self {
        let places = Places::new(photons.iter().map(|photon| photon.position), radius);
        Self { photons, places }
    }
}
