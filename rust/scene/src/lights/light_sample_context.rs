//! What light falls on.

use raywright_base::math::DVec3;
use raywright_optics::spectra::Waves;

/// A point that light is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSampleContext {
    /// Where it is.
    pub position: DVec3,
    /// The unit shading normal on the side that light counts on; zero where light from everywhere does, as at surfaces
    /// that let light through, and in media.
    pub normal: DVec3,
    /// The wavelengths at which it is asked for; none for red, green and blue.
    pub waves: Option<Waves>,
}

impl LightSampleContext {
    /// A point that light reaches from everywhere.
    pub fn free(position: DVec3) -> Self {
        Self { position, normal: DVec3::ZERO, waves: None }
    }

    /// Whether light from everywhere counts.
    #[inline(always)]
    pub fn is_free(&self) -> bool {
        // Without a branch, for lanes.
        (self.normal.x == 0.0) & (self.normal.y == 0.0) & (self.normal.z == 0.0)
    }
}
