//! The stages of paths that carry wavelengths.

use super::path_block::Block;
use super::queues::{Flags, own};
use super::waves;
use super::worker::WavefrontWorker;
use raywright_base::math::{LANES, Vec3};
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;

impl WavefrontWorker<'_> {
    /// Stage: at which wavelengths sixteen paths are.
    pub(super) fn gather_waves(&mut self) {
        if self.waves.is_empty() {
            return;
        }
        let Block { sample, spectral, surfaces, media: of, .. } = &mut *self.block;
        for lane in 0..LANES {
            spectral.waves[lane] = waves::at(&self.waves, sample[lane]);
            if let Some(flights) = &self.flights {
                let around = if surfaces.is_front[lane] != 0 { of.here[lane] } else { of.through[lane] };
                spectral.around[lane] = flights.stacks.get(around).media.dispersion();
            }
        }
    }

    /// Return whether paths share their wavelengths with known light, with a group, or with the path from the other
    /// end. Then each path chooses one of the three to sample distances by: the paths must be independent.
    pub(super) fn shares_waves(&self) -> bool {
        self.known.is_some() || self.shares() || self.end.is_some()
    }

    /// Stage: at surfaces that refract each wavelength in its own direction, paths keep the hero alone.
    pub(super) fn end_wavelengths(&mut self) {
        for lane in 0..self.block.surfaces.count {
            if self.block.spectral.ends[lane] {
                let ended = self.end_all_but_hero(lane, self.block.throughput.get(lane));
                self.block.throughput.set(lane, ended);
            }
        }
    }

    /// Stage: refraction keeps the hero alone, and a reflection weighs all wavelengths by their own reflectances.
    pub(super) fn part_wavelengths(&mut self) {
        let count = if self.waves.is_empty() { 0 } else { self.block.surfaces.count };
        for lane in 0..count {
            let parting = self.block.spectral.parting[lane].filter(|_| self.block.bsdf.goes_on(lane));
            let Some(parting) = parting else { continue };
            let throughput = self.block.next.throughput.get(lane);
            let parted = if self.block.bsdf.is_through(lane) {
                self.end_all_but_hero(lane, throughput)
            } else if self.block.bsdf.flags[lane] & Flags::SINGLE == 0 {
                self.mirror(lane, parting.mirrored(self.block.bsdf.wo(lane)), throughput)
            } else {
                throughput
            };
            self.block.next.throughput.set(lane, parted);
            self.block.next.flags[lane] |= self.block.bsdf.flags[lane] & Flags::SINGLE;
        }
    }

    /// The throughput of the path of a lane that only the hero goes on with: no other wavelength could have sampled the
    /// rest of the path.
    fn end_all_but_hero(&mut self, lane: usize, throughput: Vec3) -> Vec3 {
        let block = &mut *self.block;
        if block.bsdf.flags[lane] & Flags::SINGLE != 0 {
            return throughput;
        }
        let sample = own(block.sample[lane], self.waves.len() as u32) as usize;
        block.bsdf.flags[lane] |= Flags::SINGLE;
        self.waves[sample].now = self.waves[sample].now.alone();
        let ended = Waves::ended(Rgb::from_array(throughput.as_dvec3().to_array()));
        let drawn =
            self.media.as_mut().map_or(Rgb::ONE, |media| std::mem::replace(&mut media.paths[sample].drawn, Rgb::ONE));
        if self.shares_waves() { ended.as_vec3() } else { (ended / drawn[0]).as_vec3() }
    }

    /// The throughput of the path of a lane after the hero was reflected by chance, which the others would have been by
    /// other chances.
    fn mirror(&mut self, lane: usize, by: Rgb, throughput: Vec3) -> Vec3 {
        let mirrored = throughput * by.as_vec3();
        let (shares, place) = (self.shares_waves(), own(self.block.sample[lane], self.waves.len() as u32));
        let Some(media) = self.media.as_mut().filter(|_| !shares) else { return mirrored };
        let drawn = &mut media.paths[place as usize].drawn;
        let mean = (*drawn * by).mean();
        *drawn = *drawn * by / mean;
        mirrored / mean as f32
    }
}
