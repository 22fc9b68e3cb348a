//! The stages of a path tracer, and the loop that takes a batch of paths through them.

use super::matte::{self, Reflectances};
use super::queues::{PathLanes, PathQueue, ShadowLanes, ShadowQueue};
use super::{direct_light, emission};
use crate::dimensions::Dimensions;
use crate::{CameraSample, Job, Worker, roulette};
use raywright_base::math::{LANES, Ray, SingleLanes, gather};
use raywright_base::sampling::{SamplerColumns, SamplerLanes};
use raywright_base::simd::Level;
use raywright_base::timing::{Part, count, timed};
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_scene::{LightBlock, Scene, SurfaceBlock};

/// Paths that are taken together. 2,048 to 4,096 stay in the second cache, and fill every sixteen.
const BATCH: usize = 4096;

/// What one thread works with.
pub(super) struct WavefrontWorker<'a> {
    scene: &'a Scene,
    level: Level,
    max_depth: Option<u32>,
    roulette_depth: u32,
    reflectances: Reflectances,
    /// Paths about to follow their rays, and those that go on.
    paths: [PathQueue; 2],
    shadows: ShadowQueue,
    samplers: Option<SamplerColumns>,
    /// What each path hits first.
    primitives: Vec<u32>,
    is_occluded: Vec<bool>,
    /// The paths that have met a surface, and those that have left the scene.
    met: Vec<u32>,
    outside: Vec<u32>,
    block: Box<Block>,
}

/// Sixteen paths at a surface.
struct Block {
    surfaces: SurfaceBlock,
    reflectance: SingleLanes,
    throughput: SingleLanes,
    sample: [u32; LANES],
    lights: LightBlock,
}

impl<'a> WavefrontWorker<'a> {
    pub fn new(job: &Job<'a>, max_depth: Option<u32>, roulette_depth: u32) -> Self {
        let scene = job.scene;
        let has_normals = scene.lights().ask_for_normals();
        let zero = SingleLanes::ZERO;
        let block = Block {
            surfaces: SurfaceBlock::NONE,
            reflectance: zero,
            throughput: zero,
            sample: [0; LANES],
            lights: LightBlock::NONE,
        };
        Self {
            scene,
            level: Level::current().unwrap_or(Level::Scalar),
            max_depth,
            roulette_depth: roulette_depth.min(roulette::AT_LATEST),
            reflectances: Reflectances::new(scene),
            paths: [PathQueue::with_room(BATCH, has_normals), PathQueue::with_room(BATCH, has_normals)],
            shadows: ShadowQueue::with_room(BATCH),
            samplers: None,
            primitives: vec![0; BATCH + LANES],
            is_occluded: vec![false; BATCH + LANES],
            met: Vec::with_capacity(BATCH),
            outside: Vec::with_capacity(BATCH),
            block: Box::new(block),
        }
    }

    /// Stage: the camera's rays become paths.
    fn start(&mut self, samples: &[CameraSample]) {
        let queue = &mut self.paths[0];
        queue.rays.len = samples.len();
        for (i, CameraSample { ray, .. }) in samples.iter().enumerate() {
            for axis in 0..3 {
                queue.rays.origin[axis][i] = ray.origin[axis];
                queue.rays.direction[axis][i] = ray.direction[axis] as f32;
            }
            queue.sample[i] = i as u32;
        }
        queue.throughput.iter_mut().for_each(|column| column[..samples.len()].fill(1.0));
        queue.pdf[..samples.len()].fill(f32::INFINITY);
        queue.rays.misses[..samples.len()].fill([Ray::NO_TRIANGLE; 2]);
        let columns = self.samplers.get_or_insert_with(|| SamplerColumns::new(&samples[0].sampler));
        columns.take(samples.iter().map(|sample| &sample.sampler));
    }

    /// Stage: paths are told apart by whether they meet anything.
    fn classify(&mut self) {
        self.met.clear();
        self.outside.clear();
        for (i, &primitive) in self.primitives[..self.paths[0].rays.len].iter().enumerate() {
            if primitive == Ray::NO_TRIANGLE { &mut self.outside } else { &mut self.met }.push(i as u32);
        }
    }

    /// Stage: what is known of sixteen surfaces, and what they emit.
    fn meet(&mut self, which: std::ops::Range<usize>, radiance: &mut [Rgb]) {
        let (queue, block) = (&self.paths[0], &mut *self.block);
        let geometry = self.scene.geometry();
        geometry.meet_block(self.level, &queue.rays, &self.primitives, &self.met[which], &mut block.surfaces);
        for (column, lanes) in queue.throughput.iter().zip(&mut block.throughput.0) {
            gather(column, &block.surfaces.index, lanes);
        }
        gather(&queue.sample, &block.surfaces.index, &mut block.sample);
        emission::add_emitted(self.scene, queue, &block.surfaces, radiance);
    }

    /// Stage: light is drawn for sixteen surfaces, and its shadow rays are queued.
    fn ask_for_light(&mut self, numbers: &SamplerLanes, bounce: u32) {
        let block = &mut *self.block;
        let (mut choice, mut u) = ([0.0; LANES], [[0.0; LANES]; 2]);
        let dimension = Dimensions::of(bounce, 0).light_choice(0);
        numbers.choice_and_pair(self.level, dimension, &mut choice, &mut u);
        let (lights, geometry) = (self.scene.lights(), self.scene.geometry());
        lights.draw_block(self.level, geometry, &block.surfaces, &choice, &u, &mut block.lights);
        let (mut arriving, mut is_lit) = (SingleLanes::ZERO, [0; LANES]);
        direct_light::reflect(
            self.level,
            &block.surfaces,
            &block.lights,
            &block.reflectance,
            &block.throughput,
            &mut arriving,
            &mut is_lit,
        );
        let misses = std::array::from_fn(|lane| [block.surfaces.primitive[lane], block.lights.primitive[lane]]);
        let shadows = ShadowLanes {
            origin: &block.surfaces.origin,
            direction: &block.lights.direction,
            t_max: &block.lights.t_max,
            misses: &misses,
            arriving: &arriving,
            sample: &block.sample,
        };
        self.shadows.push(self.level, bits(&is_lit, block.surfaces.count), &shadows);
    }

    /// Stage: sixteen paths go on from matte surfaces, unless roulette ends them.
    fn scatter(&mut self, numbers: &SamplerLanes, bounce: u32) {
        let block = &mut *self.block;
        let (mut chance, mut u) = ([0.0; LANES], [[0.0; LANES]; 2]);
        // A matte surface scatters in one way: what would choose among several plays roulette.
        numbers.chance_and_pair(self.level, Dimensions::of(bounce, 0).scattering_choice(), &mut chance, &mut u);
        let (mut direction, mut pdf) = (SingleLanes::ZERO, [0.0; LANES]);
        let normal = &block.surfaces.normal;
        matte::sample(self.level, normal, &u, &block.reflectance, &mut block.throughput, &mut direction, &mut pdf);
        if bounce + 1 >= self.roulette_depth {
            matte::play(self.level, &chance, &mut block.throughput);
        }
        let [r, g, b] = &block.throughput.0;
        let goes_on: [u32; LANES] =
            std::array::from_fn(|i| u32::from(r[i] + g[i] + b[i] > 0.0 && pdf[i] > 0.0).wrapping_neg());
        let misses = std::array::from_fn(|lane| [block.surfaces.primitive[lane], Ray::NO_TRIANGLE]);
        let paths = PathLanes {
            origin: &block.surfaces.origin,
            direction: &direction,
            misses: &misses,
            throughput: &block.throughput,
            pdf: &pdf,
            normal,
            sample: &block.sample,
        };
        self.paths[1].push(self.level, bits(&goes_on, block.surfaces.count), &paths);
    }

    /// Stage: shadow rays are followed, and what arrives along those that nothing blocks is added.
    fn follow_shadows(&mut self, radiance: &mut [Rgb]) {
        let queue = &self.shadows;
        self.scene.are_occluded(self.level, &queue.rays, &mut self.is_occluded);
        let [r, g, b] = &queue.arriving;
        for (i, &is_occluded) in self.is_occluded[..queue.rays.len].iter().enumerate() {
            if !is_occluded {
                radiance[queue.sample[i] as usize] += Rgb::new(r[i].into(), g[i].into(), b[i].into());
            }
        }
    }

    /// Follows the paths of these samples to their ends, and adds what they find.
    fn follow(&mut self, samples: &[CameraSample], cancel: &Cancel, radiance: &mut [Rgb]) {
        self.start(samples);
        let Some(mut numbers) = self.samplers.as_ref().map(SamplerColumns::lanes) else { return };
        let is_dark = self.scene.lights().is_dark();
        for bounce in 0.. {
            if self.paths[0].rays.len == 0 || cancel.is_raised() {
                break;
            }
            let rays = &self.paths[0].rays;
            timed(Part::Closest, || self.scene.first_primitives(self.level, rays, &mut self.primitives));
            self.classify();
            timed(Part::Arriving, || emission::add_outside(self.scene, &self.paths[0], &self.outside, radiance));
            self.paths[1].rays.len = 0;
            self.shadows.rays.len = 0;
            count(self.met.len());
            let goes_on = self.max_depth.is_none_or(|depth| bounce < depth);
            for start in (0..self.met.len()).step_by(LANES) {
                timed(Part::Surface, || self.meet(start..self.met.len().min(start + LANES), radiance));
                if !goes_on {
                    continue;
                }
                timed(Part::Scattering, || self.reflectances.gather(&self.block.surfaces, &mut self.block.reflectance));
                if let Some(columns) = &self.samplers {
                    timed(Part::Numbers, || columns.gather(&self.block.sample, &mut numbers));
                }
                if !is_dark {
                    timed(Part::Light, || self.ask_for_light(&numbers, bounce));
                }
                timed(Part::Continuation, || self.scatter(&numbers, bounce));
            }
            timed(Part::Shadow, || self.follow_shadows(radiance));
            self.paths.swap(0, 1);
        }
    }
}

/// The lanes that have all bits, of the first so many.
#[inline]
fn bits(lanes: &[u32; LANES], count: usize) -> u32 {
    let all: u32 = lanes.iter().enumerate().map(|(lane, bits)| (bits & 1) << lane).sum();
    all & !(u32::MAX << count)
}

impl Worker for WavefrontWorker<'_> {
    fn radiance(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]) {
        assert_eq!(samples.len(), radiance.len());
        radiance.fill(Rgb::ZERO);
        for (samples, radiance) in samples.chunks(BATCH).zip(radiance.chunks_mut(BATCH)) {
            self.follow(samples, cancel, radiance);
        }
    }
}
