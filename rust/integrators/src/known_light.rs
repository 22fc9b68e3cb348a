//! Light that is known where paths come to, as from photon maps.

use super::media::current_medium::Filled;
use super::media::scattering::Scattering;
use super::nesting::MediumStack;
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use raywright_scene::SurfaceInteraction;
use raywright_scene::materials::BsdfMix;

/// Use of known light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gather {
    /// Number of final gather rays, into which a path is split at the first matte surface; none goes on from the
    /// second. 0 where none goes on.
    pub rays: u32,
    /// True if the first look-up has light through specular surfaces, as from a caustic map.
    pub caustic: bool,
}

/// A path that has come to where light is known.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Visit {
    /// Sample index within its pixel.
    pub number: u32,
    /// True if final gather rays start there, which find interreflected light.
    pub looks_about: bool,
    /// True if the path has met a surface with a reflectance above 1 in a channel
    /// ([`raywright_optics::Bsdf::repeat_correction`]).
    pub has_gamut_excess: bool,
    /// True if the hero is its only wavelength left.
    pub single: bool,
    /// Maximum number of earlier scattering events.
    pub bounces: Option<u32>,
}

/// Known light: at matte surfaces all but direct light, and in media all.
pub(crate) trait KnownLight: Send + Sync {
    /// Return the radiance scattered back along a ray by a surface.
    fn at_surface(&self, here: &SurfaceInteraction<&BsdfMix>, visit: Visit) -> Rgb;

    /// Return the wavelengths of the known light for a sample index; `None` for RGB.
    fn waves(&self, number: u32) -> Option<Waves>;

    /// Return the in-scattered radiance along a ray, per unit of scattering, at a point in given media at a time.
    fn among(&self, here: &Scattering, media: &MediumStack<Filled>, time: f64, visit: Visit) -> Rgb;
}
