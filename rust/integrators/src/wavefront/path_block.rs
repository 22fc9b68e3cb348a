//! Sixteen paths at a time.

use super::bsdf_block::{BsdfBlock, Scattered};
use super::queues::{Extra, PathQueue, ShadowLanes, ShadowQueue};
use super::waves::WavesBlock;
use raywright_base::math::{LANES, SingleLanes, Vec3, VectorLanes, gather};
use raywright_base::simd::Level;
use raywright_scene::{LightBlock, SurfaceBlock};

/// Sixteen paths at a surface.
pub(super) struct Block<'a> {
    pub(super) surfaces: SurfaceBlock,
    pub(super) reflectance: SingleLanes,
    pub(super) throughput: SingleLanes,
    pub(super) sample: [u32; LANES],
    pub(super) time: [f64; LANES],
    pub(super) lights: LightBlock,
    pub(super) bsdf: BsdfBlock<'a>,
    pub(super) next: Scattered,
    pub(super) media: MediaBlock,
    pub(super) spectral: WavesBlock,
}

/// Sixteen paths in scenes with media.
pub(super) struct MediaBlock {
    /// Media before and behind the surface, and at the start of their shadow rays.
    pub here: [u32; LANES],
    pub through: [u32; LANES],
    pub of_shadows: [u32; LANES],
    /// The index of refraction outside of the object.
    pub outside: [f64; LANES],
    /// Of directions to light, the density of scattering over that of their draw.
    pub ratio: [f32; LANES],
}

impl MediaBlock {
    /// Of no paths.
    const NONE: Self = Self {
        here: [0; LANES],
        through: [0; LANES],
        of_shadows: [0; LANES],
        outside: [1.0; LANES],
        ratio: [0.0; LANES],
    };
}

impl<'a> Block<'a> {
    /// Of no paths, with the BSDFs of their surfaces.
    pub fn new(bsdf: BsdfBlock<'a>) -> Self {
        Self {
            surfaces: SurfaceBlock::NONE,
            reflectance: SingleLanes::ZERO,
            throughput: SingleLanes::ZERO,
            sample: [0; LANES],
            time: [0.0; LANES],
            lights: LightBlock::NONE,
            bsdf,
            next: Scattered::NONE,
            media: MediaBlock::NONE,
            spectral: WavesBlock::NONE,
        }
    }
}

impl Block<'_> {
    /// Gathers sixteen paths from their queue.
    pub(super) fn gather(&mut self, queue: &PathQueue, extra: Extra) {
        let (which, position) = (&self.surfaces.index, &self.surfaces.position);
        if extra.time {
            gather(&queue.rays.time, which, &mut self.time);
        }
        for (column, lanes) in queue.throughput.iter().zip(&mut self.throughput.0) {
            gather(column, which, lanes);
        }
        gather(&queue.sample, which, &mut self.sample);
        if extra.state {
            gather(&queue.scale, which, &mut self.bsdf.scale);
            gather(&queue.flags, which, &mut self.bsdf.flags);
        }
        if extra.aimed {
            gather(&queue.aimed, which, &mut self.bsdf.guided.aimed);
        }
        if extra.width {
            let BsdfBlock { width, spread, .. } = &mut self.bsdf;
            gather(&queue.width, which, width);
            gather(&queue.spread, which, spread);
            for lane in 0..LANES {
                let origin = queue.vertex(which[lane] as usize);
                let distance = (position.get(lane) - origin).length() as f32;
                width[lane] = (width[lane] + spread[lane] * distance).abs();
            }
        }
    }

    /// The path of a lane shares its radiance from here on. Roulette keeps the throughput that is lost.
    pub(super) fn share(&mut self, lane: usize, samples: u32) {
        self.bsdf.scale[lane] *= self.throughput.get(lane).max_element();
        self.throughput.set(lane, Vec3::ONE);
        self.sample[lane] += samples;
    }

    /// Queues shadow rays from the lanes in a mask to their light samples.
    #[inline]
    pub(super) fn queue_shadows(
        &self,
        level: Level,
        mask: u32,
        (origin, arriving): (&VectorLanes, &SingleLanes),
        shadows: &mut ShadowQueue,
    ) {
        let misses = std::array::from_fn(|lane| [self.surfaces.primitive[lane], self.lights.primitive[lane]]);
        let rays = ShadowLanes {
            origin,
            direction: &self.lights.direction,
            t_max: &self.lights.t_max,
            misses: &misses,
            arriving,
            sample: &self.sample,
            time: &self.time,
            ratio: &self.media.ratio,
            media: &self.media.of_shadows,
        };
        shadows.push(level, mask, &rays);
    }
}

/// The lanes that have all bits, of the first so many, as bits.
#[inline]
pub(super) fn bits(lanes: &[u32; LANES], count: usize) -> u32 {
    const BITS: [u32; LANES] = [1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384, 32768];
    let mut all = 0;
    for i in 0..LANES {
        all |= lanes[i] & BITS[i];
    }
    all & !(u32::MAX << count)
}
