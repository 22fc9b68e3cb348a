//! Where paths go on to.

use super::Follow;
use super::aiming::{aim, aiming};
use super::block::Block;
use super::carried::Carried;
use super::guided::Arrival;
use super::path_state::PathState;
use super::splitting::Branch;
use super::worker::TransportWorker;
use crate::dimensions::Dimensions;
use crate::roulette;
use raywright_base::math::{LANES, VectorLanes};
use raywright_base::sampling::Pairs;
use raywright_base::simd::loops;
use raywright_optics::{BsdfSample, BsdfSampleLanes, Diffuse, Null, Rgb, RgbLanes};
use raywright_scene::{Interaction, SurfaceInteractionLanes};
use std::array;

loops! {
    /// From random numbers to where paths go on to from diffuse surfaces. `pdf` is 0 where it ends.
    fn go_on(
        encounters: &SurfaceInteractionLanes,
        reflectance: &RgbLanes,
        u: &Pairs,
        origin: &mut VectorLanes,
        direction: &mut VectorLanes,
        weight: &mut RgbLanes,
        pdf: &mut [f64; LANES],
    ) {
        for i in 0..LANES {
            let here = encounters.faded(i, Diffuse { reflectance: reflectance.get(i) });
            let (towards, times, density) = match here.sample(&mut || 0.0, [u[0][i], u[1][i]]) {
                Some(next) => (next.wi, next.weight, next.pdf),
                None => (here.normal(), Rgb::ZERO, 0.0),
            };
            let ray = here.ray_origin().ray(towards);
            origin.set(i, ray.origin);
            direction.set(i, ray.direction);
            weight.set(i, times);
            pdf[i] = density;
        }
    }
}

loops! {
    /// From what was drawn in shading frames to the world, and to the rays that leave. `pdf` is 0 where a path ends.
    fn leave(
        encounters: &SurfaceInteractionLanes,
        wi: &mut VectorLanes,
        weight: &mut RgbLanes,
        pdf: &mut [f64; LANES],
        origin: &mut VectorLanes,
        direction: &mut VectorLanes,
    ) {
        for i in 0..LANES {
            let here = encounters.faded(i, Null);
            let (towards, fading) = here.goes_to(wi.get(i), pdf[i] == f64::INFINITY);
            let ray = here.ray_origin().ray(towards);
            wi.set(i, towards);
            weight.set(i, weight.get(i) * fading);
            pdf[i] = if fading > 0.0 { pdf[i] } else { 0.0 };
            origin.set(i, ray.origin);
            direction.set(i, ray.direction);
        }
    }
}

impl TransportWorker<'_> {
    /// Sends paths on to where their surfaces scatter them.
    pub(super) fn go_on(&mut self, block: &Block) {
        if block.is_diffuse {
            return self.go_on_diffuse(block);
        }
        if self.settings.follow == Follow::DeltaLobes {
            (0..block.count).filter(|&lane| block.goes_on[lane]).for_each(|lane| self.split(block, lane));
        }
        if matches!(self.settings.follow, Follow::DeltaLobes | Follow::Nothing) {
            return;
        }
        let parts: [bool; LANES] = array::from_fn(|lane| block.goes_on[lane] && self.follows_both(block, lane));
        (0..block.count).filter(|&lane| parts[lane]).for_each(|lane| self.split(block, lane));
        let splits: [u32; LANES] = array::from_fn(|lane| self.splits(block, lane));
        for branch in 0..splits.into_iter().max().unwrap_or(1) {
            // The first goes on as the path that it comes from.
            let number = |lane: usize| if branch == 0 { self.carried(block, lane).branch } else { branch };
            let numbers: [u32; LANES] = array::from_fn(number);
            let dimensions: [Dimensions; LANES] =
                array::from_fn(|lane| Dimensions::of(block.paths[lane].bounce, numbers[lane]));
            let (mut choice, mut u) = ([0.0; LANES], [[0.0; LANES]; 2]);
            let choices = dimensions.map(Dimensions::scattering_choice);
            block.numbers.one_and_two(self.level, &choices, &mut choice, &mut u);
            let chances = self.chances(block, &dimensions);
            let goes: [bool; LANES] =
                array::from_fn(|lane| block.goes_on[lane] && !parts[lane] && branch < splits[lane]);
            let aims = if self.guide.is_some() { aiming(block, &goes, &mut choice) } else { [false; LANES] };
            let scatters = array::from_fn(|lane| goes[lane] && !aims[lane]);
            let ([mut origin, mut direction], mut drawn) = ([VectorLanes::ZERO; 2], BsdfSampleLanes::NONE);
            block.bsdf.sample(self.level, &scatters, block.encounters.wo_lanes(), (&choice, &u), &mut drawn);
            let as_given = |lane: &usize| block.encounters.is_as_given(*lane);
            let before = (0..block.count).any(|lane| as_given(&lane)).then(|| drawn.clone());
            let BsdfSampleLanes { wi, weight, pdf, .. } = &mut drawn;
            leave(self.level, &block.encounters, wi, weight, pdf, &mut origin, &mut direction);
            if let Some(before) = before {
                for lane in (0..block.count).filter(as_given) {
                    let (wi, given) = (before.wi.get(lane), before.pdf[lane]);
                    let counts = block.encounters.get(lane, Null).goes_to(wi, given == f64::INFINITY).1;
                    weight.set(lane, before.weight.get(lane) * counts);
                    pdf[lane] = if counts > 0.0 { given } else { 0.0 };
                }
            }
            let mut denser = [1.0; LANES];
            if self.guide.is_some() {
                let rays = [&mut origin, &mut direction];
                aim(self.level, block, (&goes, &aims), (&choice, &u), &mut drawn, rays, &mut denser);
            }
            let mut going = 0;
            for lane in (0..block.count).filter(|&lane| goes[lane]) {
                let Some(next) = drawn.get(lane) else { continue };
                let (number, splits, denser, chance) = (numbers[lane], splits[lane], denser[lane], chances[lane]);
                if self.is_followed(block, lane, next.pdf)
                    && self.send(block, lane, &next, Branch { number, splits, denser, chance })
                {
                    going |= 1 << lane;
                }
            }
            self.next.rays.push_lanes(&block.all_leaving(origin, direction, [f64::INFINITY; LANES]), going);
        }
    }

    /// Whether the path of a lane goes on along a direction that is drawn with this density.
    #[inline]
    pub(super) fn is_followed(&self, block: &Block, lane: usize, pdf: f64) -> bool {
        // What is known is scattered by all but single directions.
        if self.is_at_known(block, lane) && !self.gathers_from(block, lane) && pdf != f64::INFINITY {
            return false;
        }
        match self.settings.follow {
            Follow::All => true,
            Follow::MinDensity(than) => pdf > than,
            Follow::DeltaLobes => pdf == f64::INFINITY,
            Follow::Nothing => false,
        }
    }

    fn go_on_diffuse(&mut self, block: &Block) {
        let mut u = [[0.0; LANES]; 2];
        block.numbers.two(self.level, &block.dimensions.map(Dimensions::direction), &mut u);
        let ([mut origin, mut direction], mut weight) = ([VectorLanes::ZERO; 2], RgbLanes::ZERO);
        let mut pdf = [0.0; LANES];
        go_on(
            self.level,
            &block.encounters,
            &block.reflectance,
            &u,
            &mut origin,
            &mut direction,
            &mut weight,
            &mut pdf,
        );
        let chances = self.chances(block, &block.dimensions);
        let mut going = 0;
        for lane in 0..block.count {
            if !block.goes_on[lane] || pdf[lane] == 0.0 {
                continue;
            }
            let mut path = block.paths[lane];
            path.throughput *= weight.get(lane);
            path.pdf = pdf[lane];
            path.normal = block.receivers.get(lane).normal;
            path.each = false;
            path.bounce = path.bounce.saturating_add(1);
            if self.survives(&mut path, Arrival::GoesOn, chances[lane]) {
                going |= 1 << lane;
                self.next.paths.push(path);
                let carried = self.carried(block, lane);
                let next = || BsdfSample::new(direction.get(lane), weight.get(lane), pdf[lane]);
                let footprint = if self.widths { self.widened(block, lane, &next()) } else { carried.footprint };
                self.next.carried.push(Carried { footprint, chance: -1.0, ..*carried });
            }
        }
        self.next.rays.push_lanes(&block.all_leaving(origin, direction, [f64::INFINITY; LANES]), going);
    }

    /// The numbers for roulette, if any path of a block plays.
    fn chances(&self, block: &Block, dimensions: &[Dimensions; LANES]) -> [f64; LANES] {
        let mut chances = [0.0; LANES];
        let plays = |lane: usize| self.plays(block.paths[lane].bounce.saturating_add(1));
        if (0..block.count).any(|lane| block.goes_on[lane] && plays(lane)) {
            block.numbers.one(self.level, &dimensions.map(Dimensions::roulette), &mut chances);
        }
        chances
    }

    /// Whether roulette is played for a path after so many surfaces.
    #[inline]
    pub(super) fn plays(&self, bounce: u32) -> bool {
        bounce >= self.settings.roulette_depth.min(roulette::AT_LATEST)
    }

    /// Plays roulette where it is to be played, by a uniform number, and says whether the path goes on.
    #[inline]
    fn survives(&self, path: &mut PathState, arrival: Arrival, chance: f64) -> bool {
        if arrival != Arrival::GoesOn || !self.plays(path.bounce) {
            return true;
        }
        let survival = roulette::survival(path.throughput, path.importance());
        if chance >= survival {
            return false;
        }
        path.throughput /= survival;
        true
    }

    /// Queues a path that goes on along a direction drawn, unless roulette ends it, and says whether it did; its ray is
    /// left to be queued.
    pub(super) fn send(&mut self, block: &Block, lane: usize, next: &BsdfSample, branch: Branch) -> bool {
        let mut path = block.paths[lane];
        path.throughput *= next.weight;
        self.part(block, lane, &mut path, next);
        path.pdf = next.pdf;
        path.aim(branch.denser);
        if branch.splits > 1 {
            path.throughput /= f64::from(branch.splits);
            path.pdf *= f64::from(branch.splits);
        }
        path.normal = block.receivers.get(lane).normal;
        path.scale *= next.eta * next.eta;
        path.each = self.asks_each(block, lane);
        path.bounce = path.bounce.saturating_add(1);
        if path.throughput.max() * path.scale < self.settings.least {
            return false;
        }
        if !self.survives(&mut path, block.arrivals[lane], branch.chance) {
            return false;
        }
        self.next.paths.push(path);
        let carried = self.carried(block, lane);
        let footprint = if self.widths { self.widened(block, lane, next) } else { carried.footprint };
        let media =
            if self.passing.is_nested() && next.is_through { self.boundary(block, lane).1 } else { carried.media };
        let (is_gathered, is_sharp_since) = self.gathered(block, lane, next.is_delta());
        let (chance, branch) = (-1.0, branch.number);
        self.next.carried.push(Carried { footprint, media, chance, branch, is_gathered, is_sharp_since });
        true
    }
}
