//! How wide the bundle of neighboring rays is along a path.

use super::block::Block;
use super::worker::TransportWorker;
use crate::widths::widened;
use raywright_optics::BsdfSample;
use raywright_scene::Footprint;

impl TransportWorker<'_> {
    /// The bundle of rays after the surface of a lane.
    pub(super) fn widened(&self, block: &Block, lane: usize, next: &BsdfSample) -> Footprint {
        let before = &self.carried(block, lane).footprint;
        widened(before, block.width[lane], block.encounters.curvature(lane), next)
    }
}
