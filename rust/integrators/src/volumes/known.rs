//! Light that is known where paths are scattered, as by photons.

use super::filled::Filled;
use super::scattering::Scattering;
use crate::nesting::MediumStack;
use crate::transport::Visit;
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use raywright_scene::SurfaceInteraction;

/// What is known of light, at matt surfaces but for what comes there straight from lights, and among media.
pub(crate) trait KnownLight: Send + Sync {
    /// How much of it is scattered back along a ray by a surface.
    fn at_surface(&self, here: &SurfaceInteraction, visit: Visit) -> Rgb;

    /// The wavelengths at which it is known to samples of a number; none for red, green and blue.
    fn waves(&self, number: u32) -> Option<Waves>;

    /// How much of it a medium scatters back along a ray, of what it scatters at all, at a point that is in these
    /// media at a time.
    fn among(&self, here: &Scattering, media: &MediumStack<Filled>, time: f64, visit: Visit) -> Rgb;
}
