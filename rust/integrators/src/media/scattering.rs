//! Scattering events in media.

use raywright_base::math::DVec3;
use raywright_optics::{BsdfSample, Phase, Rgb};
use raywright_scene::{Interaction, LightSampleContext, RayOrigin};

/// A scattering event in a medium. The path weights already include the scattering coefficient.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scattering {
    pub position: DVec3,
    /// Unit direction of incidence.
    pub before: DVec3,
    pub phase: Phase,
}

impl Interaction for Scattering {
    fn position(&self) -> DVec3 {
        self.position
    }

    fn ray_origin(&self) -> RayOrigin {
        RayOrigin::free(self.position)
    }

    fn light_context(&self) -> LightSampleContext {
        LightSampleContext::free(self.position)
    }

    fn evaluate(&self, direction: DVec3) -> (Rgb, f64) {
        let pdf = self.phase.pdf(self.before, direction);
        (Rgb::splat(pdf), pdf)
    }

    fn sample(&self, _choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        let wi = self.phase.sample(self.before, u);
        Some(BsdfSample::new(wi, Rgb::ONE, self.phase.pdf(self.before, wi)))
    }
}
