//! Light at matt surfaces that is known, as by photons.

use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use raywright_scene::SurfaceInteraction;
use raywright_scene::materials::BsdfMix;

/// What becomes of paths at matt surfaces whose light is known.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gather {
    /// Into how many a path is split at the first of them; none goes on from the second. 0 where none goes on.
    pub rays: u32,
    /// Whether light that has come by way of sharp surfaces alone is known at the first.
    pub caustic: bool,
}

/// A path that has come to a matt surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Visit {
    /// Which sample of its pixel it is of.
    pub number: u32,
    /// Whether paths look about from there, so that what surfaces send each other is found by them.
    pub looks_about: bool,
    /// Whether the path has been at a surface that gives more than there is
    /// ([`raywright_optics::Bsdf::repeat_correction`]).
    pub has_gamut_excess: bool,
    /// Whether the hero of its wavelengths is all that it carries.
    pub single: bool,
    /// Surfaces that light may have been scattered at before.
    pub bounces: Option<u32>,
}

/// What is known of light at matt surfaces, but for what comes there straight from lights.
pub(crate) trait MattLight: Send + Sync {
    /// How much of it is scattered back along a ray.
    fn radiance(&self, here: &SurfaceInteraction<&BsdfMix>, visit: Visit) -> Rgb;

    /// At which wavelengths it is known for samples of a number; none for red, green and blue.
    fn waves(&self, number: u32) -> Option<Waves>;
}
