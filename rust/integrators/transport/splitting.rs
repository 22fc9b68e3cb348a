//! Paths that go on in several ways at once.

use super::block::Block;
use super::features::Features;
use super::worker::TransportWorker;
use crate::scene::Encounter;

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

impl<N: Features> TransportWorker<'_, N> {
    /// Into how many the path of a lane is split.
    #[inline]
    pub(super) fn splits(&self, block: &Block, lane: usize) -> u32 {
        if let Some(gather) = self.settings.gather.filter(|_| N::GENERAL) {
            return if self.gathers_from(block, lane) { gather.rays.max(1) } else { 1 };
        }
        if self.is_first(block, lane) { self.settings.splits } else { 1 }
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
