//! Paths at their shared vertices.

use super::camera_paths::{ONCE, Walker};
use super::path_numbers::PathNumbers;
use super::path_reuse::{FirstVertex, SecondVertex};
use super::path_state::PathState;
use super::ray_tracer::TraceRays;
use super::scattering::Scattering;
use raywright_base::math::DVec3;
use raywright_base::workers::Cancel;
use raywright_optics::{BsdfSample, Rgb};
use raywright_scene::{Interaction, LightSampleContext, RayOrigin};
use std::f64::consts::FRAC_1_PI;

/// A scattering point with an isotropic phase function. It gives incident light without a weight by direction.
struct AllWays(Scattering);

impl AllWays {
    /// Replacement for each phase function's density in MIS with light sampling: one weight for all receivers.
    const PDF: f64 = 0.25 * FRAC_1_PI;
}

impl Interaction for AllWays {
    fn position(&self) -> DVec3 {
        self.0.position()
    }

    fn ray_origin(&self) -> RayOrigin {
        self.0.ray_origin()
    }

    fn light_context(&self) -> LightSampleContext {
        self.0.light_context()
    }

    fn evaluate(&self, _direction: DVec3) -> (Rgb, f64) {
        (Rgb::ONE, Self::PDF)
    }

    fn sample(&self, choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        self.0.sample(choice, u).map(|drawn| BsdfSample::new(drawn.wi, Rgb::ONE, Self::PDF))
    }
}

impl<A: TraceRays> Walker<'_, A> {
    /// Scatter a path at a shared vertex and return whether it continues.
    pub(super) async fn scatter_shared(
        &self,
        path: &mut PathState,
        here: &Scattering,
        hero: usize,
        numbers: &mut PathNumbers<'_>,
        cancel: &Cancel,
    ) -> Option<(SecondVertex, bool)> {
        if self.settings.max_depth.is_some_and(|most| path.bounce >= most) {
            return None;
        }
        path.share();
        let (here, media) = (AllWays(*here), path.media);
        let asked = self.direct_light(&here, path, |_| media, (hero, ONCE), numbers, cancel).await;
        let (to_light, lit) = asked.map_or((DVec3::X, Rgb::ZERO), |(light, arrives)| (light.direction, arrives));
        let u = numbers.ray.direction();
        let next = here.sample(&mut || 0.0, numbers.two(u))?;
        let chance = numbers.ray.roulette();
        let goes_on = self.go_on(path, &here, &next, media, numbers.one(chance), self.never_ends());
        let second = SecondVertex::of_medium(here.position(), (to_light, lit), next.wi);
        Some((second, goes_on))
    }

    /// Return whether the segment from the first vertex to a surface lies in its medium, or leaves it just once.
    pub(super) fn is_within_reach(&self, first: &FirstVertex, path: &PathState) -> bool {
        match path.passed {
            0 => true,
            1 => first.is_alone && path.media.depth() == 0 && self.scene.surrounding().is_none(),
            _ => false,
        }
    }
}
