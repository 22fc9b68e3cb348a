//! Paths that carry wavelengths in place of red, green and blue.

use super::block::Block;
use super::path_state::PathState;
use super::worker::TransportWorker;
use crate::CameraSample;
use crate::dimensions::Dimensions;
use crate::terminate_wavelengths::Parting;
use raywright_base::math::LANES;
use raywright_optics::spectra::Waves;
use raywright_optics::{BsdfSample, Dispersive, Rgb};
use raywright_scene::{LookupContext, SurfacePoint};

impl TransportWorker<'_> {
    /// Draws the wavelengths of samples, in a scene that needs them.
    pub(super) fn draw_waves(&mut self, samples: &mut [CameraSample]) {
        if self.scene.plan().needs().waves {
            self.waves.clear();
            let known = self.known;
            self.waves.extend(samples.iter_mut().map(|sample| {
                let of_known = known.and_then(|known| known.waves(sample.sampler.number()));
                of_known.unwrap_or_else(|| Waves::of(sample.sampler.one(Dimensions::WAVES)))
            }));
        }
    }

    /// The wavelengths of a path for a sample; none for red, green and blue.
    #[inline]
    pub(super) fn waves(&self, sample: u32) -> Option<Waves> {
        self.waves.get(sample as usize).copied()
    }

    /// How the path of a lane looks at a point.
    #[inline]
    pub(super) fn gaze(&self, block: &Block, lane: usize) -> LookupContext {
        LookupContext { width: block.width[lane], waves: self.waves(block.paths[lane].sample) }
    }

    /// Says at which wavelengths light is asked for.
    pub(super) fn set_waves(&self, block: &mut Block) {
        if !self.waves.is_empty() {
            for lane in 0..LANES {
                block.receivers.set_waves(lane, self.waves(block.paths[lane].sample));
            }
        }
    }

    /// What parts the wavelengths of the path of a lane at a surface, and the index of refraction around that.
    pub(super) fn parting(
        &self,
        block: &Block,
        lane: usize,
        surface: &SurfacePoint,
        outside: f64,
    ) -> (f64, Option<Parting>) {
        let Some(waves) = self.waves(block.paths[lane].sample) else { return (outside, None) };
        let is_front = surface.is_front(&block.rays[lane]);
        let around = match (self.passing.is_nested(), is_front) {
            (false, _) => Dispersive::NONE,
            (true, true) => self.carried(block, lane).media.dispersion(),
            (true, false) => self.boundary(block, lane).1.dispersion(),
        };
        Parting::at(self.scene.material_at(surface), is_front, (outside, around), &waves)
    }

    /// Parts the wavelengths of the path of a lane that goes on along a direction drawn, if they have come together so
    /// far.
    #[inline]
    pub(super) fn part(&self, block: &Block, lane: usize, path: &mut PathState, next: &BsdfSample) {
        if let Some(parting) = &block.parting[lane] {
            if next.is_through {
                path.end_all_but_hero();
            } else if !path.single {
                path.throughput *= parting.mirrored(block.encounters.wo_lanes().get(lane));
            }
        }
    }

    /// Makes of what was found at the wavelengths of samples what they look like.
    pub(super) fn see_waves(&self, radiance: &mut [Rgb]) {
        for (light, waves) in radiance.iter_mut().zip(&self.waves) {
            *light = waves.seen(*light);
        }
    }
}
