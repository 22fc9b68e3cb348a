//! What happens where paths have come to.

use super::block::Block;
use super::carried::Carried;
use super::worker::TransportWorker;
use crate::CameraSample;
use raywright_base::math::LANES;
use raywright_base::timing::{Part, count, timed};
use raywright_optics::Rgb;
use std::array;

impl<'a> TransportWorker<'a> {
    /// Takes paths, at most sixteen, from their rays' hits to their next rays.
    pub(super) fn shade(
        &mut self,
        block: &mut Block<'a>,
        which: &[u32],
        samples: &mut [CameraSample],
        radiance: &mut [Rgb],
    ) {
        count(which.len());
        timed(Part::Surface, || self.gather(block, which));
        timed(Part::Emission, || self.add_emission(block, radiance));
        if !block.goes_on.contains(&true) {
            return;
        }
        timed(Part::Scattering, || self.meet(block, samples, radiance));
        if !self.scene.lights().is_dark() {
            timed(Part::Light, || self.direct_light(block));
        }
        timed(Part::Continuation, || self.go_on(block));
    }

    /// What the path of a lane carries.
    #[inline]
    pub(super) fn carried(&self, block: &Block, lane: usize) -> &Carried {
        &self.now.carried[block.index[lane] as usize]
    }

    /// Looks up where paths have come to.
    fn gather(&self, block: &mut Block, which: &[u32]) {
        block.count = which.len();
        block.index = array::from_fn(|lane| which[lane.min(which.len() - 1)]);
        self.now.rays.gather(&block.index, &mut block.rays);
        for lane in 0..LANES {
            let index = block.index[lane] as usize;
            block.hits[lane] = self.hits[index];
            block.paths[lane] = self.now.paths[index];
            block.goes_on[lane] = false;
            block.width[lane] = 0.0;
            if self.widths {
                block.width[lane] = self.now.carried[index].footprint.at(self.hits[index].t).width;
            }
        }
        self.scene.geometry().surface_lanes(self.level, &block.rays, &block.hits, &mut block.surfaces);
    }

    /// Adds what surfaces emit, and finds out which paths may go on.
    fn add_emission(&self, block: &mut Block, radiance: &mut [Rgb]) {
        for lane in 0..block.count {
            let (path, surface) = (&block.paths[lane], block.surfaces.get(lane));
            if self.shines(&surface) && !self.is_known(self.carried(block, lane)) {
                let emitted =
                    self.emitted(&block.rays[lane], &block.hits[lane], &surface, path, self.gaze(block, lane));
                radiance[path.sample as usize] += path.throughput * emitted;
            }
            block.goes_on[lane] = self.settings.max_depth.is_none_or(|depth| path.bounce < depth);
        }
    }
}
