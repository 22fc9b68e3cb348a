//! Encounters with diffuse surfaces, sixteen at a time.

use super::alive::Alive;
use super::dimensions::Dimensions;
use super::features::{Baggage, Features};
use super::weights::{ROULETTE_AT_LATEST, power_heuristic, survival};
use super::worker::TransportWorker;
use crate::integrators::CameraSample;
use crate::math::{LANES, Ray, VectorLanes};
use crate::optics::{Diffuse, Rgb};
use crate::sampling::{Pairs, SamplerLanes};
use crate::scene::{Interaction, InteractionLanes, LightLanes, ReceiverLanes, SurfaceLanes};
use crate::simd::Loops;
use std::array;

/// From rays that meet surfaces to what is known of the encounters.
struct Meet<'a> {
    directions: &'a VectorLanes,
    reflectance: &'a VectorLanes,
    encounters: &'a mut InteractionLanes,
    receivers: &'a mut ReceiverLanes,
}

impl Loops for Meet<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        meet(self.directions, self.reflectance, self.encounters, self.receivers);
    }
}

#[inline(always)]
#[allow(clippy::too_many_arguments)]
fn meet(
    directions: &VectorLanes,
    reflectance: &VectorLanes,
    encounters: &mut InteractionLanes,
    receivers: &mut ReceiverLanes,
) {
    for i in 0..LANES {
        let surface = encounters.surface(i);
        let scattering = Diffuse { reflectance: reflectance.get(i) };
        let ray = Ray::new(surface.position, directions.get(i));
        let here = Interaction::with(&ray, surface, (surface.shading_normal, None), scattering);
        encounters.set(i, &here);
        receivers.set(i, &here.receiver());
    }
}

/// From light that was drawn to what arrives of it, and the rays that tell whether it does.
struct Ask<'a> {
    encounters: &'a InteractionLanes,
    reflectance: &'a VectorLanes,
    throughput: &'a VectorLanes,
    lights: &'a LightLanes,
    arriving: &'a mut VectorLanes,
    origin: &'a mut VectorLanes,
    direction: &'a mut VectorLanes,
    t_max: &'a mut [f64; LANES],
}

impl Loops for Ask<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        ask(
            self.encounters,
            self.reflectance,
            self.throughput,
            self.lights,
            self.arriving,
            self.origin,
            self.direction,
            self.t_max,
        );
    }
}

#[inline(always)]
#[allow(clippy::too_many_arguments)]
fn ask(
    encounters: &InteractionLanes,
    reflectance: &VectorLanes,
    throughput: &VectorLanes,
    lights: &LightLanes,
    arriving: &mut VectorLanes,
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
        let from = here.departure();
        let (segment, ray) = (from.segment(&source), from.ray(towards));
        let ray = if is_within { segment } else { ray };
        origin.set(i, ray.origin);
        direction.set(i, ray.direction);
        t_max[i] = ray.t_max;
    }
}

/// From random numbers to where paths go on to.
struct GoOn<'a> {
    encounters: &'a InteractionLanes,
    reflectance: &'a VectorLanes,
    u: &'a Pairs,
    origin: &'a mut VectorLanes,
    direction: &'a mut VectorLanes,
    weight: &'a mut VectorLanes,
    /// 0 where it ends.
    pdf: &'a mut [f64; LANES],
}

impl Loops for GoOn<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        go_on(self.encounters, self.reflectance, self.u, self.origin, self.direction, self.weight, self.pdf);
    }
}

#[inline(always)]
#[allow(clippy::too_many_arguments)]
fn go_on(
    encounters: &InteractionLanes,
    reflectance: &VectorLanes,
    u: &Pairs,
    origin: &mut VectorLanes,
    direction: &mut VectorLanes,
    weight: &mut VectorLanes,
    pdf: &mut [f64; LANES],
) {
    for i in 0..LANES {
        let here = encounters.get(i, Diffuse { reflectance: reflectance.get(i) });
        let next = here.sample(|| 0.0, [u[0][i], u[1][i]]);
        let (towards, times, density) = match next {
            Some(next) => (next.direction, next.weight, next.pdf),
            None => (here.normal(), Rgb::ZERO, 0.0),
        };
        let ray = here.departure().ray(towards);
        origin.set(i, ray.origin);
        direction.set(i, ray.direction);
        weight.set(i, times);
        pdf[i] = density;
    }
}

impl<N: Features> TransportWorker<'_, N> {
    /// How a shape scatters, if that is by one diffuse colour and paths need no more of it.
    #[inline]
    pub(super) fn diffuse(&self, shape: u32) -> Option<Rgb> {
        self.scene.plan().diffuse(shape).filter(|_| self.in_lanes)
    }

    /// Takes paths, at most sixteen, from their rays' hits on diffuse surfaces to their next rays.
    pub(super) fn shade_diffuse(&mut self, which: &[u32], samples: &[CameraSample], radiance: &mut [Rgb]) {
        let (level, count) = (self.level, which.len());
        let at = |lane: usize| which[lane.min(count - 1)] as usize;
        let rays: [Ray; LANES] = array::from_fn(|lane| self.now.rays[at(lane)]);
        let hits = array::from_fn(|lane| self.hits[at(lane)]);
        let mut paths: [Alive; LANES] = array::from_fn(|lane| self.now.alive[at(lane)]);
        let baggage = |lane: usize| if N::BAGGAGE { &self.now.baggage[at(lane)] } else { &Baggage::NONE };
        let mut surfaces = SurfaceLanes::NONE;
        self.scene.geometry().surface_lanes(level, &rays, &hits, &mut surfaces);
        let [mut directions, mut reflectance, mut throughput] = [VectorLanes::ZERO; 3];
        for lane in 0..LANES {
            directions.set(lane, rays[lane].direction);
            reflectance.set(lane, self.diffuse(surfaces.shape(lane)).unwrap_or(Rgb::ZERO));
        }
        let mut goes_on = [false; LANES];
        for lane in 0..count {
            let path = &paths[lane];
            if self.scene.lights().shines(surfaces.shape(lane)) {
                let emitted = self.emitted(&rays[lane], &hits[lane], &surfaces.get(lane), path, baggage(lane));
                radiance[path.sample as usize] += path.throughput * emitted;
            }
            goes_on[lane] = self.settings.max_depth.is_none_or(|depth| path.bounce < depth);
        }
        if !goes_on.contains(&true) {
            return;
        }
        let (mut encounters, mut receivers) = (InteractionLanes::at(&surfaces), ReceiverLanes::NONE);
        level.compiled(Meet {
            directions: &directions,
            reflectance: &reflectance,
            encounters: &mut encounters,
            receivers: &mut receivers,
        });
        let sampler = |path: &Alive| &samples[Self::own(path.sample, samples.len())].sampler;
        let mut numbers = SamplerLanes::new(sampler(&paths[0]));
        let dimensions: [Dimensions; LANES] =
            array::from_fn(|lane| Dimensions::of(paths[lane].bounce, baggage(lane).branch));
        for lane in 0..LANES {
            numbers.set(lane, sampler(&paths[lane]));
            if N::SHARES && goes_on[lane] {
                let here = encounters.get(lane, Diffuse { reflectance: reflectance.get(lane) });
                paths[lane] = self.reuse.visit(paths[lane], &here);
            }
            throughput.set(lane, paths[lane].throughput);
        }
        let [mut origin, mut direction, mut colour] = [VectorLanes::ZERO; 3];
        let (mut number, mut u) = ([0.0; LANES], [[0.0; LANES]; 2]);
        if !self.scene.lights().is_dark() {
            numbers.one_and_two(level, &dimensions.map(|d| d.light_choice(0)), &mut number, &mut u);
            let mut lights = LightLanes::NONE;
            self.scene.lights().sample_lanes(level, self.scene.geometry(), &receivers, &number, &u, &mut lights);
            let mut t_max = [0.0; LANES];
            level.compiled(Ask {
                encounters: &encounters,
                reflectance: &reflectance,
                throughput: &throughput,
                lights: &lights,
                arriving: &mut colour,
                origin: &mut origin,
                direction: &mut direction,
                t_max: &mut t_max,
            });
            for lane in 0..count {
                let arriving = colour.get(lane);
                if goes_on[lane] && arriving != Rgb::ZERO {
                    let ray = Ray {
                        t_max: t_max[lane],
                        time: rays[lane].time,
                        ..Ray::new(origin.get(lane), direction.get(lane))
                    };
                    self.shadows.push(ray, paths[lane].sample, arriving);
                    if N::BAGGAGE && self.nested {
                        self.shadows.set_inside(self.now.baggage[at(lane)].inside);
                    }
                }
            }
        }
        numbers.two(level, &dimensions.map(Dimensions::direction), &mut u);
        let mut pdf = [0.0; LANES];
        level.compiled(GoOn {
            encounters: &encounters,
            reflectance: &reflectance,
            u: &u,
            origin: &mut origin,
            direction: &mut direction,
            weight: &mut colour,
            pdf: &mut pdf,
        });
        let first = self.settings.roulette_depth.min(ROULETTE_AT_LATEST);
        let plays = |path: &Alive| (!N::SHARES || path.bounce > 0) && path.bounce.saturating_add(1) >= first;
        if (0..count).any(|lane| goes_on[lane] && pdf[lane] > 0.0 && plays(&paths[lane])) {
            numbers.one(level, &dimensions.map(Dimensions::roulette), &mut number);
        }
        for lane in 0..count {
            if !goes_on[lane] || pdf[lane] == 0.0 {
                continue;
            }
            let is_played = plays(&paths[lane]);
            let mut path = paths[lane];
            path.throughput *= colour.get(lane);
            path.pdf = pdf[lane];
            path.normal = receivers.get(lane).normal;
            path.each = false;
            path.bounce = path.bounce.saturating_add(1);
            if is_played {
                let survival = survival(path.throughput, path.importance());
                if number[lane] >= survival {
                    continue;
                }
                path.throughput /= survival;
            }
            self.next.rays.push(Ray { time: rays[lane].time, ..Ray::new(origin.get(lane), direction.get(lane)) });
            self.next.alive.push(path);
            if N::BAGGAGE {
                self.next.baggage.push(Baggage { chance: -1.0, ..self.now.baggage[at(lane)] });
            }
        }
    }
}
