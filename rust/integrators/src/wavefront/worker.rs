//! The stages of a path tracer, and the loop that takes a batch of paths through them.

use super::matte::{self, Reflectances};
use super::queues::{PathLanes, PathQueue, ShadowLanes, ShadowQueue};
use super::{direct_light, emission};
use crate::dimensions::Dimensions;
use crate::path_sharing::{PathSharing, SharingPoint};
use crate::{CameraSample, CameraSamples, Job, Worker, roulette};
use raywright_base::math::{LANES, Ray, SingleLanes, Vec3, gather};
use raywright_base::sampling::{SamplerColumns, SamplerLanes};
use raywright_base::simd::Level;
use raywright_base::timing::{Part, count, timed};
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_scene::{LightBlock, Scene, SurfaceBlock};
use std::ops::Range;

/// Paths that are taken together. 2,048 to 4,096 stay in the second cache, and fill every sixteen.
const BATCH: usize = 4096;

/// What one thread works with.
pub(super) struct WavefrontWorker<'a> {
    scene: &'a Scene,
    level: Level,
    max_depth: Option<u32>,
    roulette_depth: u32,
    /// What paths of a group share, if they do.
    sharing: Option<PathSharing>,
    /// What samples find for themselves, and then what they find for sharing.
    found: Vec<Rgb>,
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
    pub fn new(job: &Job<'a>, max_depth: Option<u32>, roulette_depth: u32, shares: bool) -> Self {
        let (scene, level) = (job.scene, Level::current().unwrap_or(Level::Scalar));
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
            level,
            max_depth,
            roulette_depth: roulette_depth.min(roulette::AT_LATEST),
            sharing: shares.then(|| PathSharing::new(level)),
            found: Vec::new(),
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

    /// Make room for so many paths.
    fn make_room(&mut self, most: usize) {
        if self.primitives.len() < most + LANES {
            let has_normals = self.scene.lights().ask_for_normals();
            self.paths = [PathQueue::with_room(most, has_normals), PathQueue::with_room(most, has_normals)];
            self.shadows = ShadowQueue::with_room(most);
            self.primitives.resize(most + LANES, 0);
            self.is_occluded.resize(most + LANES, false);
        }
    }

    /// Stage: some of the camera's rays become paths.
    fn start(&mut self, samples: &CameraSamples, some: Range<usize>) {
        self.make_room(some.len());
        let (queue, count) = (&mut self.paths[0], some.len());
        queue.rays.len = count;
        for axis in 0..3 {
            queue.rays.origin[axis][..count].copy_from_slice(&samples.origin[axis][some.clone()]);
            for (to, &from) in queue.rays.direction[axis].iter_mut().zip(&samples.direction[axis][some.clone()]) {
                *to = from as f32;
            }
        }
        for (i, sample) in (0..).zip(&mut queue.sample[..count]) {
            *sample = i;
        }
        queue.throughput.iter_mut().for_each(|column| column[..count].fill(1.0));
        queue.pdf[..count].fill(f32::INFINITY);
        queue.rays.misses[..count].fill([Ray::NO_TRIANGLE; 2]);
        if let Some(samplers) = &samples.samplers {
            self.samplers.get_or_insert_with(|| samplers.clone()).take_from(samplers, some);
        }
    }

    /// Stage: paths are told apart by whether they meet anything.
    fn classify(&mut self) {
        let count = self.paths[0].rays.len;
        self.met.resize(count, 0);
        self.outside.resize(count, 0);
        // Both are written, and one grows.
        let (mut met, mut outside) = (0, 0);
        for (i, &primitive) in (0u32..).zip(&self.primitives[..count]) {
            (self.met[met], self.outside[outside]) = (i, i);
            let is_met = usize::from(primitive != Ray::NO_TRIANGLE);
            (met, outside) = (met + is_met, outside + 1 - is_met);
        }
        self.met.truncate(met);
        self.outside.truncate(outside);
    }

    /// Stage: what is known of sixteen surfaces, and what they emit.
    fn meet(&mut self, which: Range<usize>, radiance: &mut [Rgb]) {
        let (queue, block) = (&self.paths[0], &mut *self.block);
        let geometry = self.scene.geometry();
        geometry.meet_block(self.level, &queue.rays, &self.primitives, &self.met[which], &mut block.surfaces);
        for (column, lanes) in queue.throughput.iter().zip(&mut block.throughput.0) {
            gather(column, &block.surfaces.index, lanes);
        }
        gather(&queue.sample, &block.surfaces.index, &mut block.sample);
        emission::add_emitted(self.scene, queue, &block.surfaces, radiance);
    }

    /// Stage: sixteen paths come to the first or second point of a group that shares.
    fn visit(&mut self, bounce: u32, samples: u32) {
        let (Some(sharing), block) = (&mut self.sharing, &mut *self.block) else { return };
        let rgb = |lanes: &SingleLanes, lane: usize| {
            let v = lanes.get(lane);
            Rgb::new(v.x.into(), v.y.into(), v.z.into())
        };
        for lane in 0..block.surfaces.count {
            let reflectance = rgb(&block.reflectance, lane);
            if reflectance.is_black() {
                continue;
            }
            let (sample, throughput) = (block.sample[lane], rgb(&block.throughput, lane));
            let normal = block.surfaces.normal.get(lane);
            let point = SharingPoint {
                position: block.surfaces.position.get(lane),
                origin: block.surfaces.origin.get(lane),
                shading: normal,
                normal,
                primitive: block.surfaces.primitive[lane],
            };
            if bounce == 0 {
                sharing.add_first(sample, &point, throughput * reflectance);
            } else if sharing.add_second(sample, &point, throughput) {
                block.throughput.set(lane, Vec3::ONE);
                block.sample[lane] = sample + samples;
            }
        }
    }

    /// Stage: light is drawn for sixteen surfaces, and its shadow rays are queued.
    fn ask_for_light(&mut self, numbers: &SamplerLanes, bounce: u32) {
        let block = &mut *self.block;
        let (mut choice, mut u) = ([0.0; LANES], [[0.0; LANES]; 2]);
        let dimension = Dimensions::of(bounce, 0).light_choice(0);
        let (lights, geometry) = (self.scene.lights(), self.scene.geometry());
        if lights.choices_are_even() {
            let mut chance = [0.0; LANES];
            numbers.chance_and_pair(self.level, dimension, &mut chance, &mut u);
            choice = chance.map(f64::from);
        } else {
            numbers.choice_and_pair(self.level, dimension, &mut choice, &mut u);
        }
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
        // The density with which a path comes to the second point that it shares must be known.
        if bounce + 1 >= self.roulette_depth && (bounce > 0 || self.sharing.is_none()) {
            matte::play(self.level, &chance, &mut block.throughput);
        }
        let mut goes_on = [0; LANES];
        matte::survive(self.level, &block.throughput, &pdf, &mut goes_on);
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
    fn follow(&mut self, samples: &CameraSamples, some: Range<usize>, cancel: &Cancel, radiance: &mut [Rgb]) {
        let samples_here = some.len() as u32;
        self.start(samples, some);
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
                    let own = self.block.sample.map(|sample| sample.min(sample.wrapping_sub(samples_here)));
                    timed(Part::Numbers, || columns.gather(&own, &mut numbers));
                }
                if bounce < 2 && self.sharing.is_some() {
                    self.visit(bounce, samples_here);
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

impl WavefrontWorker<'_> {
    /// Follows the paths of groups that share, as many groups at a time as make a batch.
    fn follow_groups(&mut self, samples: &CameraSamples, groups: &[u32], cancel: &Cancel, radiance: &mut [Rgb]) {
        let Some(mut sharing) = self.sharing.take() else { return };
        let mut found = std::mem::take(&mut self.found);
        let (mut groups, mut start) = (groups, 0);
        while !groups.is_empty() && !cancel.is_raised() {
            let (mut some, mut count) = (0, 0);
            while some < groups.len() && (some == 0 || count + groups[some] as usize <= BATCH) {
                count += groups[some] as usize;
                some += 1;
            }
            let (these, rest) = groups.split_at(some);
            let radiance = &mut radiance[start..start + count];
            found.clear();
            found.resize(2 * count, Rgb::ZERO);
            sharing.begin(count);
            self.sharing = Some(sharing);
            self.follow(samples, start..start + count, cancel, &mut found);
            sharing = self.sharing.take().unwrap_or_else(|| PathSharing::new(self.level));
            let (own, shared) = found.split_at(count);
            radiance.copy_from_slice(own);
            let number = |sample: u32| {
                let samplers = samples.samplers.as_ref();
                samplers.map_or(0.0, |all| all.get(start + sample as usize).one(Dimensions::SHARING))
            };
            sharing.share(self.scene, these, shared, cancel, radiance, number);
            (groups, start) = (rest, start + count);
        }
        (self.sharing, self.found) = (Some(sharing), found);
    }
}

/// The lanes that have all bits, of the first so many, as bits.
#[inline]
fn bits(lanes: &[u32; LANES], count: usize) -> u32 {
    const BITS: [u32; LANES] = [1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384, 32768];
    let mut all = 0;
    for i in 0..LANES {
        all |= lanes[i] & BITS[i];
    }
    all & !(u32::MAX << count)
}

impl Worker for WavefrontWorker<'_> {
    fn radiance(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]) {
        let columns = CameraSamples::of(samples);
        self.radiance_of_columns(&columns, &[], &mut Vec::new(), cancel, radiance);
    }

    fn radiance_in_groups(
        &mut self,
        samples: &mut [CameraSample],
        groups: &[u32],
        cancel: &Cancel,
        radiance: &mut [Rgb],
    ) {
        self.radiance_of_columns(&CameraSamples::of(samples), groups, &mut Vec::new(), cancel, radiance);
    }

    fn radiance_of_columns(
        &mut self,
        samples: &CameraSamples,
        groups: &[u32],
        _: &mut Vec<CameraSample>,
        cancel: &Cancel,
        radiance: &mut [Rgb],
    ) {
        assert_eq!(samples.len, radiance.len());
        radiance.fill(Rgb::ZERO);
        if self.sharing.is_some() {
            let each = vec![1; if groups.is_empty() { samples.len } else { 0 }];
            return self.follow_groups(samples, if groups.is_empty() { &each } else { groups }, cancel, radiance);
        }
        for start in (0..samples.len).step_by(BATCH) {
            let end = samples.len.min(start + BATCH);
            self.follow(samples, start..end, cancel, &mut radiance[start..end]);
        }
    }
}
