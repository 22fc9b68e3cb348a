//! Light that is asked for where paths have come to.

use super::block::Block;
use super::features::Features;
use super::guided::density;
use super::resampling::Resampled;
use super::weights::power_heuristic;
use super::worker::TransportWorker;
use crate::math::{DVec3, LANES, VectorLanes};
use crate::optics::{Bsdf, Diffuse, Rgb, RgbLanes};
use crate::scene::{Encounter, LightLanes, LightSample, SurfaceInteractionLanes};
use crate::simd::loops;
use std::array;

loops! {
    /// From light that was drawn for diffuse surfaces to what arrives of it, and the rays that tell whether it does.
    fn ask(
        encounters: &SurfaceInteractionLanes,
        reflectance: &RgbLanes,
        throughput: &RgbLanes,
        lights: &LightLanes,
        arriving: &mut RgbLanes,
        origin: &mut VectorLanes,
        direction: &mut VectorLanes,
        t_max: &mut [f64; LANES],
    ) {
        for i in 0..LANES {
            let here = encounters.get(i, Diffuse { reflectance: reflectance.get(i) });
            let (towards, light, drawn) = lights.get(i);
            let (scattered, pdf) = here.evaluate(towards);
            let all = throughput.get(i) * scattered * light * power_heuristic(drawn, pdf);
            arriving.set(i, if drawn > 0.0 { all } else { Rgb::ZERO });
            let (source, is_within) = lights.source(i);
            let from = here.ray_origin();
            let (segment, ray) = (from.segment(&source), from.ray(towards));
            let ray = if is_within { segment } else { ray };
            origin.set(i, ray.origin);
            direction.set(i, ray.direction);
            t_max[i] = ray.t_max;
        }
    }
}

/// The choice of one of several draws: each makes its own in a share of all.
#[inline]
fn share(choice: f64, (number, asked): (u32, u32)) -> f64 {
    if asked == 1 { choice } else { ((choice + f64::from(number)) / f64::from(asked)).min(1f64.next_down()) }
}

impl<N: Features> TransportWorker<'_, N> {
    /// Next-event estimation: draws light for each lane and queues the shadow rays.
    pub(super) fn direct_light(&mut self, block: &Block) {
        if block.is_diffuse {
            return self.ask_diffuse(block);
        }
        let mut numbers = [(0, 0); LANES];
        for (lane, number) in numbers.iter_mut().enumerate().take(block.count) {
            if block.goes_on[lane] && !block.bsdf[lane].is_delta() && !self.is_light_known(block, lane) {
                number.1 = if self.is_first(block, lane) { self.settings.light_samples } else { 1 };
            }
        }
        while numbers.iter().any(|(number, asked)| number < asked) {
            self.ask_others(block, &numbers);
            numbers.iter_mut().for_each(|(number, _)| *number += 1);
        }
    }

    /// Whether the path of a lane is at its first surface, where it may be split.
    #[inline]
    pub(super) fn is_first(&self, block: &Block, lane: usize) -> bool {
        N::GENERAL && block.paths[lane].bounce == 0
    }

    fn ask_diffuse(&mut self, block: &Block) {
        let (mut choice, mut u) = ([0.0; LANES], [[0.0; LANES]; 2]);
        block.numbers.one_and_two(self.level, &block.dimensions.map(|d| d.light_choice(0)), &mut choice, &mut u);
        let (mut lights, lit) = (LightLanes::NONE, self.scene.lights());
        lit.sample_lanes(self.level, self.scene.geometry(), &block.receivers, &choice, &u, &mut lights);
        let ([mut origin, mut direction], mut t_max) = ([VectorLanes::ZERO; 2], [0.0; LANES]);
        let mut arriving = RgbLanes::ZERO;
        ask(
            self.level,
            &block.encounters,
            &block.reflectance,
            &block.throughput,
            &lights,
            &mut arriving,
            &mut origin,
            &mut direction,
            &mut t_max,
        );
        let mut asked = 0;
        for lane in 0..block.count {
            let arriving = arriving.get(lane);
            if block.goes_on[lane] && !arriving.is_black() {
                asked |= 1 << lane;
                self.bring(block, lane, direction.get(lane), arriving);
            }
        }
        let mut rays = block.all_leaving(origin, direction, t_max);
        for lane in 0..LANES {
            rays.misses[lane][1] = lights.primitive(lane);
        }
        self.shadows.push_lanes(&rays, asked);
    }

    /// Asks once for each lane whose number is below how often it asks.
    fn ask_others(&mut self, block: &Block, numbers: &[(u32, u32); LANES]) {
        let asks: [bool; LANES] = array::from_fn(|lane| lane < block.count && numbers[lane].0 < numbers[lane].1);
        let each: [bool; LANES] = array::from_fn(|lane| asks[lane] && self.asks_each(block, lane));
        let one: [bool; LANES] = array::from_fn(|lane| asks[lane] && !each[lane]);
        if one.contains(&true) {
            self.ask_one_light(block, numbers, &one);
        }
        if each.contains(&true) {
            self.ask_each_light(block, numbers, &each);
        }
    }

    /// Draws light of one light for some lanes.
    fn ask_one_light(&mut self, block: &Block, numbers: &[(u32, u32); LANES], asks: &[bool; LANES]) {
        let (mut choice, mut u) = ([0.0; LANES], [[0.0; LANES]; 2]);
        let dimensions = array::from_fn(|lane| block.dimensions[lane].light_choice(numbers[lane].0));
        block.numbers.one_and_two(self.level, &dimensions, &mut choice, &mut u);
        for lane in 0..LANES {
            choice[lane] = share(choice[lane], (numbers[lane].0, numbers[lane].1.max(1)));
        }
        let (mut lights, lit) = (LightLanes::NONE, self.scene.lights());
        lit.sample_lanes(self.level, self.scene.geometry(), &block.receivers, &choice, &u, &mut lights);
        for lane in (0..block.count).filter(|&lane| asks[lane]) {
            if let Some(light) = lights.sample(lane) {
                let arriving = self.arriving(block, lane, &light, numbers[lane].1);
                if !arriving.is_black() {
                    self.send_towards(block, lane, &light, arriving);
                }
            }
        }
    }

    /// Draws light of each of few lights for some lanes, and of it one draw to stand for all.
    fn ask_each_light(&mut self, block: &Block, numbers: &[(u32, u32); LANES], asks: &[bool; LANES]) {
        let (lit, geometry) = (self.scene.lights(), self.scene.geometry());
        let first = numbers.map(|(number, _)| number.wrapping_mul(lit.few()));
        let (mut choice, mut u, mut lights) = ([0.0; LANES], [[0.0; LANES]; 2], LightLanes::NONE);
        let choices = array::from_fn(|lane| block.dimensions[lane].light_choice(first[lane]));
        block.numbers.one(self.level, &choices, &mut choice);
        let mut all: [Resampled<LightSample>; LANES] =
            array::from_fn(|lane| Resampled::new(share(choice[lane], (numbers[lane].0, numbers[lane].1.max(1)))));
        for one in 0..lit.few() {
            let dimensions = array::from_fn(|lane| block.dimensions[lane].light_choice(first[lane].wrapping_add(one)));
            block.numbers.one_and_two(self.level, &dimensions, &mut choice, &mut u);
            lit.sample_one_lanes(one, self.level, geometry, &block.receivers, &choice, &u, &mut lights);
            for lane in (0..block.count).filter(|&lane| asks[lane]) {
                if let Some(light) = lights.sample(lane) {
                    all[lane].add(light, self.arriving(block, lane, &light, numbers[lane].1));
                }
            }
        }
        for (lane, all) in all.into_iter().enumerate() {
            if let Some((light, arriving)) = all.kept() {
                self.send_towards(block, lane, &light, arriving);
            }
        }
    }

    /// Whether each of few lights is asked where the path of a lane is.
    #[inline]
    pub(super) fn asks_each(&self, block: &Block, lane: usize) -> bool {
        !N::PLAIN && !block.is_diffuse && self.scene.plan().asks_each(|| block.bsdf[lane].roughness())
    }

    /// Queues the shadow ray of light that was drawn.
    fn send_towards(&mut self, block: &Block, lane: usize, light: &LightSample, arriving: Rgb) {
        let from = block.other(lane).ray_origin();
        let ray = match &light.source {
            Some(source) => from.segment(source),
            None => from.ray(light.direction),
        };
        let mut ray = block.leaving(lane, ray);
        ray.misses[1] = light.primitive;
        self.shadows.push(&ray);
        self.bring(block, lane, light.direction, arriving);
    }

    /// Says what arrives at the sample of a lane along a shadow ray that leaves in a direction.
    #[inline]
    fn bring(&mut self, block: &Block, lane: usize, direction: DVec3, arriving: Rgb) {
        self.shadows.bring(block.paths[lane].sample, arriving);
        if N::GENERAL && self.passing.is_nested() {
            let is_through = !block.is_diffuse && block.other(lane).is_through(direction);
            let media = if is_through { self.boundary(block, lane).1 } else { self.carried(block, lane).media };
            self.shadows.start_in(media);
        }
    }

    /// What light that was drawn adds to the sample, one of so many draws, if nothing is in its way.
    #[inline]
    fn arriving(&self, block: &Block, lane: usize, light: &LightSample, asked: u32) -> Rgb {
        let (scattered, mut pdf) = block.other(lane).evaluate(light.direction);
        if let Some(guide) = &block.guides[lane] {
            pdf = density(guide, pdf, light.direction);
        }
        let splits = self.splits(block, lane);
        let mut weight = if self.is_followed(block, lane, pdf) {
            power_heuristic(light.pdf * f64::from(asked), pdf * f64::from(splits))
        } else {
            1.0
        };
        if N::GENERAL {
            weight /= f64::from(asked);
        }
        block.paths[lane].throughput * scattered * light.weight * weight
    }
}
