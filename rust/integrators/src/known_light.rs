//! Light that is known where paths come to, as from photon maps.

use super::media::current_medium::Filled;
use super::media::scattering::Scattering;
use super::nesting::MediumStack;
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use raywright_scene::SurfaceInteraction;
use raywright_scene::materials::BsdfMix;

/// What becomes of paths where light is known.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gather {
    /// Number of final gather rays, into which a path is split at the first matte surface; none goes on from the
    /// second. 0 where none goes on.
    pub rays: u32,
    /// Whether light that has come by way of specular surfaces alone is known at the first.
    pub caustic: bool,
}

/// A path that has come to where light is known.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Visit {
    /// Which sample of its pixel it is of.
    pub number: u32,
    /// Whether final gather rays start there, so that they find what surfaces send each other.
    pub looks_about: bool,
    /// Whether the path has been at a surface whose reflectance is above 1 in a channel
    /// ([`raywright_optics::Bsdf::repeat_correction`]).
    pub has_gamut_excess: bool,
    /// Whether the hero of its wavelengths is all that it carries.
    pub single: bool,
    /// Number of surfaces that may have scattered light before.
    pub bounces: Option<u32>,
}

/// What is known: at matte surfaces all light but direct light, and in media all light.
pub(crate) trait KnownLight: Send + Sync {
    /// Return the radiance scattered back along a ray by a surface.
    fn at_surface(&self, here: &SurfaceInteraction<&BsdfMix>, visit: Visit) -> Rgb;

    /// Return the wavelengths of the known light for a sample index; `None` for RGB.
    fn waves(&self, number: u32) -> Option<Waves>;

    /// Return the in-scattered radiance along a ray, per unit of scattering, at a point in given media at a time.
    fn among(&self, here: &Scattering, media: &MediumStack<Filled>, time: f64, visit: Visit) -> Rgb;
}
