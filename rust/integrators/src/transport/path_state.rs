//! Paths on their way.

use super::carried::Carried;
use raywright_base::math::{DVec3, RayQueue};
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;

/// A path on its way.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathState {
    pub(super) throughput: Rgb,
    /// The normal that lights were drawn by where it was scattered last ([`raywright_scene::LightSampleContext`]).
    pub(super) normal: DVec3,
    /// Density with which this direction was drawn, times the number of such draws; infinite for a camera's ray.
    pub(super) pdf: f64,
    /// How much less radiance is here than where the path started, because of the index of refraction alone.
    pub(super) scale: f64,
    /// Whose sample it is, plus the number of samples where what is found is for sharing.
    pub(super) sample: u32,
    /// Surfaces that it has been scattered at.
    pub(super) bounce: u32,
    /// Whether each of few lights was asked where it was scattered last.
    pub(super) each: bool,
    /// Whether it has come to a surface that gives more than there is, in a channel.
    pub(super) has_gamut_excess: bool,
    /// Whether the hero of its wavelengths is all that it carries.
    pub(super) single: bool,
    /// How much denser directions were drawn than surfaces scatter into them, since the last matt one
    /// ([`super::guided`]).
    pub(super) aimed: f32,
}

impl PathState {
    /// That of a camera's ray for a sample.
    pub(super) fn of_camera(sample: u32) -> Self {
        Self {
            throughput: Rgb::ONE,
            normal: DVec3::ZERO,
            pdf: f64::INFINITY,
            scale: 1.0,
            sample,
            bounce: 0,
            each: false,
            has_gamut_excess: false,
            single: false,
            aimed: 1.0,
        }
    }

    /// It goes on along a direction that was drawn so much more densely than the surface scatters into it.
    #[inline]
    pub(super) fn aim(&mut self, denser: f64) {
        /// So that it stays finite.
        const MOST: f32 = 1e30;
        self.aimed = (self.aimed * denser as f32).min(MOST);
    }

    /// It comes to a surface that leaves so much of its light if it has been at such a surface before
    /// ([`raywright_optics::Bsdf::repeat_correction`]).
    #[inline]
    pub(super) fn meet(&mut self, again: Rgb) {
        if again != Rgb::ONE {
            if self.has_gamut_excess {
                self.throughput *= again;
            }
            self.has_gamut_excess = true;
        }
    }

    /// Leaves the hero of its wavelengths alone, which stands for all from here on.
    pub(super) fn end_all_but_hero(&mut self) {
        if !self.single {
            self.throughput = Waves::ended(self.throughput);
            self.single = true;
        }
    }

    /// What the throughput is multiplied by for roulette: no light is lost where it is small only because of the index
    /// of refraction, or because the path was aimed.
    #[inline]
    pub(super) fn importance(&self) -> f64 {
        self.scale * f64::from(self.aimed)
    }
}

/// Paths that go on, and the ray that each is about to follow.
#[derive(Default)]
pub(super) struct Queue {
    pub rays: RayQueue,
    pub paths: Vec<PathState>,
    pub carried: Vec<Carried>,
}

impl Queue {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.rays.clear();
        self.paths.clear();
        self.carried.clear();
    }
}
