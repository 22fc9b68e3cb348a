//! Surfaces that reflect diffusely.

use super::direct_light;
use super::queues::{Flags, PathLanes};
use super::worker::{WavefrontWorker, bits};
use crate::dimensions::Dimensions;
use crate::roulette;
use raywright_base::math::single::{choose, cosine_hemisphere, greater, lesser, mask, to_world};
use raywright_base::math::{LANES, Ray, SingleLanes, Vec3};
use raywright_base::sampling::SamplerLanes;
use raywright_base::simd::loops;
use raywright_base::timing::{Part, timed};
use raywright_scene::{Scene, SurfaceBlock};
use std::f32::consts::FRAC_1_PI;

/// What each shape reflects on the front and on the back.
pub(super) struct Reflectances(Vec<[Vec3; 2]>);

impl Reflectances {
    pub fn new(scene: &Scene) -> Self {
        let of =
            |shape: u32| scene.plan().diffuse(shape).map_or([Vec3::ZERO; 2], |sides| sides.map(|side| side.as_vec3()));
        Self((0..scene.geometry().shapes() as u32).map(of).collect())
    }

    /// Those of the sides that rays have met.
    #[inline]
    pub fn gather(&self, surfaces: &SurfaceBlock, reflectance: &mut SingleLanes) {
        for lane in 0..LANES {
            let side = (!surfaces.is_front[lane] & 1) as usize;
            reflectance.set(lane, self.0[surfaces.shape[lane] as usize][side]);
        }
    }
}

loops! {
    /// Draws directions by the cosine, each of which keeps the reflectance of the throughput.
    pub(super) fn sample(
        normal: &SingleLanes,
        u: &[[f32; LANES]; 2],
        reflectance: &SingleLanes,
        throughput: &mut SingleLanes,
        direction: &mut SingleLanes,
        pdf: &mut [f32; LANES],
    ) {
        for i in 0..LANES {
            let local = cosine_hemisphere([u[0][i], u[1][i]]);
            direction.set(i, to_world(normal.get(i), local));
            throughput.set(i, throughput.get(i) * reflectance.get(i));
            pdf[i] = local.z * FRAC_1_PI;
        }
    }
}

loops! {
    /// Plays Russian roulette by numbers in [0, 1): what goes on has its throughput raised; of the others it is zero.
    /// `scale` is the ratio of radiance at the start of a path to that here due to the index of refraction alone.
    pub(super) fn play(chance: &[f32; LANES], scale: &[f32; LANES], throughput: &mut SingleLanes) {
        for i in 0..LANES {
            let t = throughput.get(i);
            let survival = lesser((greater(greater(t.x, t.y), t.z) * scale[i]).sqrt(), roulette::SURVIVAL as f32);
            let goes_on = mask(chance[i] < survival);
            throughput.set(i, t * choose(goes_on, 1.0 / survival, 0.0));
        }
    }
}

loops! {
    /// All bits where a path goes on.
    pub(super) fn survive(throughput: &SingleLanes, pdf: &[f32; LANES], goes_on: &mut [u32; LANES]) {
        for i in 0..LANES {
            let t = throughput.get(i);
            goes_on[i] = mask(t.x + t.y + t.z > 0.0) & mask(pdf[i] > 0.0);
        }
    }
}

impl WavefrontWorker<'_> {
    /// Takes sixteen paths from matte surfaces to their next rays.
    pub(super) fn leave_matte(&mut self, numbers: &SamplerLanes, bounce: u32, samples: u32) {
        timed(Part::Scattering, || self.reflectances.gather(&self.block.surfaces, &mut self.block.reflectance));
        if bounce < 2 && self.sharing.is_some() {
            self.visit(bounce, samples);
        }
        if !self.scene.lights().is_dark() {
            timed(Part::Light, || self.ask_for_light(numbers, bounce));
        }
        timed(Part::Continuation, || self.scatter(numbers, bounce));
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
        let (surfaces, normal) = (&block.surfaces, &block.surfaces.normal);
        lights.draw_block(self.level, geometry, surfaces, normal, &choice, &u, &mut block.lights);
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
        let mask = bits(&is_lit, block.surfaces.count);
        self.shadows.push_block(self.level, mask, &self.block.surfaces.origin, &arriving, &self.block);
    }

    /// Stage: sixteen paths go on from matte surfaces, unless roulette ends them.
    fn scatter(&mut self, numbers: &SamplerLanes, bounce: u32) {
        let plays = self.plays(bounce);
        let block = &mut *self.block;
        let (mut chance, mut u) = ([0.0; LANES], [[0.0; LANES]; 2]);
        // A matte surface scatters in one way: what would choose among several plays roulette.
        numbers.chance_and_pair(self.level, Dimensions::of(bounce, 0).scattering_choice(), &mut chance, &mut u);
        let (mut direction, mut pdf) = (SingleLanes::ZERO, [0.0; LANES]);
        let normal = &block.surfaces.normal;
        sample(self.level, normal, &u, &block.reflectance, &mut block.throughput, &mut direction, &mut pdf);
        if plays {
            play(self.level, &chance, &block.bsdf.scale, &mut block.throughput);
        }
        let mut goes_on = [0; LANES];
        survive(self.level, &block.throughput, &pdf, &mut goes_on);
        let misses = std::array::from_fn(|lane| [block.surfaces.primitive[lane], Ray::NO_TRIANGLE]);
        let paths = PathLanes {
            origin: &block.surfaces.origin,
            direction: &direction,
            misses: &misses,
            throughput: &block.throughput,
            pdf: &pdf,
            normal,
            sample: &block.sample,
            scale: &block.bsdf.scale,
            flags: &block.bsdf.flags.map(|flags| flags & !Flags::ASKED_EACH),
            aimed: &block.bsdf.guided.aimed,
            width: &block.bsdf.width,
            spread: &block.bsdf.spread,
            time: &block.time,
        };
        self.paths[1].push(self.level, bits(&goes_on, block.surfaces.count), &paths);
    }
}
