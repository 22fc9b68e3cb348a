//! Paths at matt surfaces whose light is known: they end there, or after they have looked about once. Only what such a
//! surface reflects in single directions, as a coat does, is not known, and is followed as a mirror's.

use super::block::Block;
use super::carried::Carried;
use super::known::Visit;
use super::worker::TransportWorker;
use crate::is_matt;
use raywright_optics::Rgb;

impl TransportWorker<'_> {
    /// Whether light at the surface of a lane is known.
    #[inline]
    pub(super) fn is_at_known(&self, block: &Block, lane: usize) -> bool {
        let has_path = lane < block.count && !block.is_diffuse;
        self.settings.gather.is_some() && has_path && is_matt(block.bsdf.get(lane))
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
        knows && carried.is_gathered && carried.is_sharp_since
    }

    /// Whether what lights send to the surface of a lane was known where its path was gathered.
    #[inline]
    pub(super) fn is_light_known(&self, block: &Block, lane: usize) -> bool {
        let knows = self.settings.gather.is_some_and(|gather| gather.caustic);
        knows && self.carried(block, lane).is_gathered && !self.is_at_known(block, lane)
    }

    /// What is known of the light at the surface of a lane, for a sample of a number.
    pub(super) fn known_light(&self, block: &Block, lane: usize, number: u32) -> Rgb {
        let Some(known) = self.known.filter(|_| self.is_at_known(block, lane)) else { return Rgb::ZERO };
        let path = &block.paths[lane];
        let bounces = self.settings.max_depth.map(|depth| depth.saturating_sub(path.bounce + 1));
        let (looks_about, has_gamut_excess) = (self.gathers_from(block, lane), path.has_gamut_excess);
        let visit = Visit { number, looks_about, has_gamut_excess, single: path.single, bounces };
        path.throughput * known.radiance(&block.other(lane), visit)
    }

    /// Of a path that goes on from the surface of a lane, in a single direction or not: whether it is gathered, and
    /// whether it has been at something sharp since. A coat that is like a mirror is one, whatever lies below.
    pub(super) fn gathered(&self, block: &Block, lane: usize, is_single: bool) -> (bool, bool) {
        let was = self.carried(block, lane).is_gathered;
        if self.is_at_known(block, lane) && !is_single { (true, false) } else { (was, was) }
    }
}
