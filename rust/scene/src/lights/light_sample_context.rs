//! Receivers of light samples.

use raywright_base::math::DVec3;
use raywright_optics::spectra::Waves;

/// Reference point of light sampling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSampleContext {
    /// Position.
    pub position: DVec3,
    /// Unit shading normal of the hemisphere that contributes; zero if all directions do, as for transmissive surfaces
    /// and media.
    pub normal: DVec3,
    /// Wavelengths; `None` for red, green and blue.
    pub waves: Option<Waves>,
}

impl LightSampleContext {
    /// A receiver that light reaches from all directions.
    pub fn free(position: DVec3) -> Self {
        Self { position, normal: DVec3::ZERO, waves: None }
    }

    /// Returns whether all directions contribute.
    #[inline(always)]
    pub fn is_free(&self) -> bool {
        // Branch-free, for lanes.
        (self.normal.x == 0.0) & (self.normal.y == 0.0) & (self.normal.z == 0.0)
    }
}
