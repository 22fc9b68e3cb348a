//! Paths that go on in several ways at once.

use super::block::Block;
use super::worker::TransportWorker;
use raywright_optics::Bsdf;
use raywright_scene::Interaction;

/// One of so many ways that a path goes on.
#[derive(Clone, Copy)]
pub(super) struct Branch {
    /// Its number among all branches of the sample.
    pub number: u32,
    /// How many there are at this surface.
    pub splits: u32,
    /// How much more densely it was drawn than the surface scatters.
    pub denser: f64,
    /// The number for roulette.
    pub chance: f64,
}

impl TransportWorker<'_> {
    /// Into how many the path of a lane is split.
    #[inline]
    pub(super) fn splits(&self, block: &Block, lane: usize) -> u32 {
        if let Some(gather) = self.settings.gather {
            return if self.gathers_from(block, lane) { gather.rays.max(1) } else { 1 };
        }
        if self.is_first(block, lane) { self.settings.splits } else { 1 }
    }

    /// Whether the path of a lane goes on both as glass reflects it and as that refracts it: where light at matt
    /// surfaces is known, at the first few surfaces. Paths are cheap there beside what is known, and a lamp that is
    /// seen after two or three reflections within glass would be met once in a thousand samples, all the brighter.
    #[inline]
    pub(super) fn follows_both(&self, block: &Block, lane: usize) -> bool {
        const SURFACES: u32 = 3;
        if self.settings.gather.is_none() || lane >= block.count {
            return false;
        }
        let (bounce, bsdf) = (block.paths[lane].bounce, block.bsdf.get(lane));
        let is_glass = bsdf.is_delta() && bsdf.transmits();
        let is_early = bounce < SURFACES && !self.plays(bounce + 1) && !self.carried(block, lane).is_gathered;
        is_glass && is_early && block.parting[lane].is_none()
    }

    /// Follows every single direction that the surface of a lane scatters into.
    pub(super) fn split(&mut self, block: &Block, lane: usize) {
        let here = block.other(lane);
        let mut branch =
            Branch { number: self.carried(block, lane).branch.wrapping_mul(2), splits: 1, denser: 1.0, chance: 0.0 };
        block.bsdf.get(lane).delta_lobes(here.wo(), |single| {
            if let Some(next) = here.to_world(single) {
                if self.send(block, lane, &next, branch) {
                    self.next.rays.push(&block.leaving(lane, here.ray_origin().ray(next.wi)));
                }
                branch.number = branch.number.wrapping_add(1);
            }
        });
    }
}
