//! Precomputed light at vertices, as from photon maps.

use super::scattering::Scattering;
use crate::media::current_medium::Filled;
use crate::nesting::MediumStack;
use crate::transport::Visit;
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use raywright_scene::SurfaceInteraction;

/// Precomputed light: at matte surfaces all but direct light, and in media all light.
pub(crate) trait KnownLight: Send + Sync {
    /// Return the radiance scattered back along a ray by a surface.
    fn at_surface(&self, here: &SurfaceInteraction, visit: Visit) -> Rgb;

    /// Return the wavelengths of the precomputed light for a sample index; `None` for RGB.
    fn waves(&self, number: u32) -> Option<Waves>;

    /// Return the in-scattered radiance along a ray, per unit of scattering, at a point in given media at a time.
    fn among(&self, here: &Scattering, media: &MediumStack<Filled>, time: f64, visit: Visit) -> Rgb;
}
