//! Light that is asked for where paths have come to.

use super::block::Block;
use super::guided::density;
use super::worker::TransportWorker;
use crate::mis_weight::power_heuristic;
use crate::resampling::{ResampledLanes, resample};
use raywright_base::math::{DVec3, LANES, VectorLanes};
use raywright_base::simd::loops;
use raywright_optics::{Bsdf, Diffuse, Null, Rgb, RgbLanes};
use raywright_scene::{Interaction, LightLanes, SurfaceInteractionLanes};
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
            let here = encounters.faded(i, Diffuse { reflectance: reflectance.get(i) });
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

loops! {
    /// From light that was drawn to where it comes from in the shading frames, and how much it counts there: 0 where
    /// there is none.
    fn turn(
        encounters: &SurfaceInteractionLanes,
        lights: &LightLanes,
        wi: &mut VectorLanes,
        counts: &mut [f64; LANES],
    ) {
        for i in 0..LANES {
            let (direction, _, drawn) = lights.get(i);
            let (local, fading) = encounters.faded(i, Null).seen_from(direction);
            wi.set(i, local);
            counts[i] = if drawn > 0.0 { fading } else { 0.0 };
        }
    }
}

loops! {
    /// What arrives of light that was drawn, by how it is scattered.
    fn weigh(
        throughput: &RgbLanes,
        lights: &LightLanes,
        scattered: &RgbLanes,
        pdf: &[f64; LANES],
        counts: &[f64; LANES],
        asks: &[bool; LANES],
        asked: &[f64; LANES],
        splits: &[f64; LANES],
        followed: &[f64; LANES],
        arriving: &mut RgbLanes,
    ) {
        for i in 0..LANES {
            let (_, light, drawn) = lights.get(i);
            let beside = power_heuristic(drawn * asked[i], pdf[i] * splits[i]);
            let weight = if followed[i] > 0.0 { beside } else { 1.0 } / asked[i];
            let all = throughput.get(i) * (scattered.get(i) * counts[i]) * light * weight;
            arriving.set(i, Rgb::select(asks[i] & (drawn > 0.0), all, Rgb::ZERO));
        }
    }
}

loops! {
    /// The rays that tell whether light that was drawn arrives.
    fn aim(
        encounters: &SurfaceInteractionLanes,
        lights: &LightLanes,
        origin: &mut VectorLanes,
        direction: &mut VectorLanes,
        t_max: &mut [f64; LANES],
    ) {
        for i in 0..LANES {
            let (source, is_within) = lights.source(i);
            let from = encounters.faded(i, Null).ray_origin();
            let (segment, ray) = (from.segment(&source), from.ray(lights.get(i).0));
            let ray = if is_within { segment } else { ray };
            origin.set(i, ray.origin);
            direction.set(i, ray.direction);
            t_max[i] = ray.t_max;
        }
    }
}

/// The choice of one of several draws: each makes its own in a share of all.
#[inline]
pub(crate) fn share(choice: f64, (number, asked): (u32, u32)) -> f64 {
    if asked == 1 { choice } else { ((choice + f64::from(number)) / f64::from(asked)).min(1f64.next_down()) }
}

impl TransportWorker<'_> {
    /// Next-event estimation: draws light for each lane and queues the shadow rays.
    pub(super) fn direct_light(&mut self, block: &Block) {
        if block.is_diffuse {
            return self.ask_diffuse(block);
        }
        let mut numbers = [(0, 0); LANES];
        for (lane, number) in numbers.iter_mut().enumerate().take(block.count) {
            if block.goes_on[lane] && !block.bsdf.get(lane).is_delta() && !self.is_light_known(block, lane) {
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
        block.paths[lane].bounce == 0
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
        let arriving = self.arriving(block, &lights, numbers, asks);
        self.send_towards(block, &lights, &arriving);
    }

    /// Draws light of each of few lights for some lanes, and of it one draw to stand for all.
    fn ask_each_light(&mut self, block: &Block, numbers: &[(u32, u32); LANES], asks: &[bool; LANES]) {
        let (lit, geometry) = (self.scene.lights(), self.scene.geometry());
        let first = numbers.map(|(number, _)| number.wrapping_mul(lit.few()));
        let (mut choice, mut u) = ([0.0; LANES], [[0.0; LANES]; 2]);
        let choices = array::from_fn(|lane| block.dimensions[lane].light_choice(first[lane]));
        block.numbers.one(self.level, &choices, &mut choice);
        let shares = array::from_fn(|lane| share(choice[lane], (numbers[lane].0, numbers[lane].1.max(1))));
        let mut all = ResampledLanes::new(shares);
        let mut each = std::mem::take(&mut self.each);
        each.resize(lit.few() as usize, LightLanes::NONE);
        for (one, lights) in (0u32..).zip(&mut each) {
            let dimensions = array::from_fn(|lane| block.dimensions[lane].light_choice(first[lane].wrapping_add(one)));
            block.numbers.one_and_two(self.level, &dimensions, &mut choice, &mut u);
            lit.sample_one_lanes(one, self.level, geometry, &block.receivers, &choice, &u, lights);
            resample(self.level, &mut all, one.into(), &self.arriving(block, lights, numbers, asks));
        }
        let (mut lights, mut arriving) = (LightLanes::NONE, RgbLanes::ZERO);
        for lane in 0..block.count {
            if let Some((one, brings)) = all.kept(lane) {
                lights.copy(lane, &each[one]);
                arriving.set(lane, brings);
            }
        }
        self.each = each;
        self.send_towards(block, &lights, &arriving);
    }

    /// Whether each of few lights is asked where the path of a lane is.
    #[inline]
    pub(super) fn asks_each(&self, block: &Block, lane: usize) -> bool {
        !block.is_diffuse && self.scene.plan().asks_each(|| block.bsdf.get(lane).roughness())
    }

    /// Queues the shadow rays of light that was drawn, in the lanes where anything arrives of it.
    fn send_towards(&mut self, block: &Block, lights: &LightLanes, arriving: &RgbLanes) {
        let mut asked = 0;
        for lane in 0..block.count {
            if !arriving.get(lane).is_black() {
                asked |= 1 << lane;
                self.bring(block, lane, lights.get(lane).0, arriving.get(lane));
            }
        }
        if asked == 0 {
            return;
        }
        let ([mut origin, mut direction], mut t_max) = ([VectorLanes::ZERO; 2], [0.0; LANES]);
        aim(self.level, &block.encounters, lights, &mut origin, &mut direction, &mut t_max);
        let mut rays = block.all_leaving(origin, direction, t_max);
        for lane in 0..LANES {
            rays.misses[lane][1] = lights.primitive(lane);
        }
        self.shadows.push_lanes(&rays, asked);
    }

    /// Says what arrives at the sample of a lane along a shadow ray that leaves in a direction.
    #[inline]
    fn bring(&mut self, block: &Block, lane: usize, direction: DVec3, arriving: Rgb) {
        self.shadows.bring(block.paths[lane].sample, arriving);
        if self.passing.is_nested() {
            let is_through = !block.is_diffuse && block.other(lane).is_through(direction);
            let media = if is_through { self.boundary(block, lane).1 } else { self.carried(block, lane).media };
            self.shadows.start_in(media);
        }
    }

    /// What light that was drawn adds to samples, of so many draws each, if nothing is in its way.
    fn arriving(
        &self,
        block: &Block,
        lights: &LightLanes,
        numbers: &[(u32, u32); LANES],
        asks: &[bool; LANES],
    ) -> RgbLanes {
        let (mut wi, mut counts) = (VectorLanes::ZERO, [0.0; LANES]);
        turn(self.level, &block.encounters, lights, &mut wi, &mut counts);
        for lane in (0..block.count).filter(|&lane| block.encounters.is_as_given(lane)) {
            let (direction, _, drawn) = lights.get(lane);
            counts[lane] = if drawn > 0.0 { block.encounters.get(lane, Null).seen_from(direction).1 } else { 0.0 };
        }
        let (mut scattered, mut pdf) = (RgbLanes::ZERO, [0.0; LANES]);
        let seen = array::from_fn(|lane| asks[lane] && counts[lane] > 0.0);
        block.bsdf.evaluate(self.level, &seen, block.encounters.wo_lanes(), &wi, &mut scattered, &mut pdf);
        for lane in (0..block.count).filter(|&lane| asks[lane]) {
            if let Some(guide) = &block.guides[lane] {
                pdf[lane] = density(self.level, guide, pdf[lane], lights.get(lane).0);
            }
        }
        let asked = &numbers.map(|(_, asked)| f64::from(asked.max(1)));
        let splits = array::from_fn(|lane| f64::from(self.splits(block, lane)));
        let followed =
            array::from_fn(|lane| if asks[lane] && self.is_followed(block, lane, pdf[lane]) { 1.0 } else { 0.0 });
        let mut arriving = RgbLanes::ZERO;
        weigh(
            self.level,
            &block.throughput,
            lights,
            &scattered,
            &pdf,
            &counts,
            asks,
            asked,
            &splits,
            &followed,
            &mut arriving,
        );
        arriving
    }
}
