//! Matt surfaces whose light is known, as by photons: paths end there, or after they have looked about once.

use super::block::Block;
use super::features::{Carried, Features};
use super::worker::TransportWorker;
use crate::integrators::is_matt;
use crate::optics::Rgb;
use crate::scene::SurfaceInteraction;
use crate::scene::materials::BsdfMix;

/// What becomes of paths at matt surfaces whose light is known.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrators) struct Gather {
    /// Into how many a path is split at the first of them; none goes on from the second. 0 where none goes on.
    pub rays: u32,
    /// Whether light that has come by way of sharp surfaces alone is known at the first.
    pub caustic: bool,
}

/// A path that has come to a matt surface.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrators) struct Visit {
    /// Which sample of its pixel it is of.
    pub number: u32,
    /// Whether paths look about from there, so that what surfaces send each other is found by them.
    pub looks_about: bool,
    /// Surfaces that light may have been scattered at before.
    pub bounces: Option<u32>,
}

/// What is known of light at matt surfaces, but for what comes there straight from lights.
pub(in crate::integrators) trait MattLight: Send + Sync {
    /// How much of it is scattered back along a ray.
    fn radiance(&self, here: &SurfaceInteraction<&BsdfMix>, visit: Visit) -> Rgb;
}

impl<N: Features> TransportWorker<'_, N> {
    /// Whether light at the surface of a lane is known.
    #[inline]
    pub(super) fn is_at_known(&self, block: &Block, lane: usize) -> bool {
        N::GENERAL && self.settings.gather.is_some() && !block.is_diffuse && is_matt(block.bsdf.get(lane))
    }

    /// Whether the path of a lane looks about from its surface.
    #[inline]
    pub(super) fn gathers_from(&self, block: &Block, lane: usize) -> bool {
        let looks = self.settings.gather.is_some_and(|gather| gather.rays > 0);
        looks && !self.carried(block, lane).is_gathered && self.is_at_known(block, lane)
    }

    /// Whether what shines at the end of a path was known where that was gathered.
    #[inline]
    pub(super) fn is_known(&self, carried: &Carried) -> bool {
        let knows = self.settings.gather.is_some_and(|gather| gather.caustic);
        N::GENERAL && knows && carried.is_gathered && carried.is_sharp_since
    }

    /// Whether what lights send to the surface of a lane was known where its path was gathered.
    #[inline]
    pub(super) fn is_light_known(&self, block: &Block, lane: usize) -> bool {
        let knows = self.settings.gather.is_some_and(|gather| gather.caustic);
        N::GENERAL && knows && self.carried(block, lane).is_gathered && !self.is_at_known(block, lane)
    }

    /// What is known of the light at the surface of a lane, for a sample of a number.
    pub(super) fn known_light(&self, block: &Block, lane: usize, number: u32) -> Rgb {
        let Some(known) = self.known.filter(|_| self.is_at_known(block, lane)) else { return Rgb::ZERO };
        let path = &block.paths[lane];
        let bounces = self.settings.max_depth.map(|depth| depth.saturating_sub(path.bounce + 1));
        let visit = Visit { number, looks_about: self.gathers_from(block, lane), bounces };
        path.throughput * known.radiance(&block.other(lane), visit)
    }

    /// Of a path that goes on from the surface of a lane: whether it is gathered, and whether it has been at something
    /// sharp since.
    pub(super) fn gathered(&self, block: &Block, lane: usize) -> (bool, bool) {
        let carried = self.carried(block, lane);
        if self.is_at_known(block, lane) { (true, false) } else { (carried.is_gathered, carried.is_gathered) }
    }
}
