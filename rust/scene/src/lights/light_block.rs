//! Light drawn for sixteen points of surfaces at a time, in f32.

use super::choice::Choice;
use super::lamp::{Form, LampLanes, choose_triangles};
use super::sphere_block::draw_spheres;
use super::triangle_block::draw_triangles;
use super::{LightSample, LightSampleContext, Lights};
use crate::geometry::SurfaceBlock;
use crate::textures::TexturePoint;
use crate::{Geometry, RayOrigin};
use raywright_base::math::single::{cosine_hemisphere, to_world};
use raywright_base::math::{DVec3, LANES, PathRays, Ray, SingleLanes, Vec3, VectorLanes};
use raywright_base::simd::{Level, loops};
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use std::f32::consts::{FRAC_1_PI, PI};

/// Light on its way to points of surfaces, a lane each.
#[derive(Clone, Debug)]
pub struct LightBlock {
    /// Unit directions that it comes from.
    pub direction: SingleLanes,
    /// Radiance over density, by channel.
    pub weight: SingleLanes,
    /// Density in solid angle with which each direction was drawn; 0 where the draw gave no light, infinite for single
    /// directions.
    pub pdf: [f32; LANES],
    /// How far away it sets out.
    pub t_max: [f64; LANES],
    /// On which triangle it sets out, or [`Ray::NO_TRIANGLE`].
    pub primitive: [u32; LANES],
}

loops! {
    /// The ways from points to places.
    fn relative(place: &VectorLanes, position: &VectorLanes, way: &mut SingleLanes) {
        for i in 0..LANES {
            way.set(i, (place.get(i) - position.get(i)).as_vec3());
        }
    }
}

loops! {
    /// Draws light of a sky that is the same everywhere, by the cosine of its arrival.
    fn draw_sky(
        radiance: Vec3,
        normal: &SingleLanes,
        u: &[[f32; LANES]; 2],
        direction: &mut SingleLanes,
        weight: &mut SingleLanes,
        pdf: &mut [f32; LANES],
    ) {
        for i in 0..LANES {
            let local = cosine_hemisphere([u[0][i], u[1][i]]);
            direction.set(i, to_world(normal.get(i), local));
            weight.set(i, radiance * (PI / local.z));
            pdf[i] = local.z * FRAC_1_PI;
        }
    }
}

/// Points of surfaces or of media that ask for light, a lane each.
#[derive(Clone, Copy, Debug)]
pub struct ReceiverBlock<'a> {
    /// Where they are.
    pub surfaces: &'a SurfaceBlock,
    /// Normals of surfaces that reflect only; zero of others, and in media.
    pub normal: &'a SingleLanes,
    /// Wavelengths of the light; `None` for red, green and blue.
    pub waves: &'a [Option<Waves>; LANES],
}

impl ReceiverBlock<'_> {
    /// Where a lane asks for light.
    fn place(&self, lane: usize) -> DVec3 {
        let is_free = self.normal.get(lane) == Vec3::ZERO;
        if is_free { self.surfaces.position.get(lane) } else { self.surfaces.origin.get(lane) }
    }

    /// The receiver of a lane.
    fn get(&self, lane: usize) -> LightSampleContext {
        let normal = self.normal.get(lane).as_dvec3();
        LightSampleContext { position: self.place(lane), normal, waves: self.waves[lane] }
    }

    /// Where all lanes ask for light.
    fn places(&self) -> VectorLanes {
        let mut places = VectorLanes::ZERO;
        (0..LANES).for_each(|lane| places.set(lane, self.place(lane)));
        places
    }
}

impl LightBlock {
    /// No light.
    pub const NONE: Self = Self {
        direction: SingleLanes::ZERO,
        weight: SingleLanes::ZERO,
        pdf: [0.0; LANES],
        t_max: [f64::INFINITY; LANES],
        primitive: [Ray::NO_TRIANGLE; LANES],
    };

    /// Takes over a lane.
    #[inline]
    pub fn copy(&mut self, lane: usize, from: &Self) {
        self.direction.set(lane, from.direction.get(lane));
        self.weight.set(lane, from.weight.get(lane));
        (self.pdf[lane], self.t_max[lane], self.primitive[lane]) =
            (from.pdf[lane], from.t_max[lane], from.primitive[lane]);
    }

    /// Puts what was drawn for a receiver into a lane.
    fn set(&mut self, lane: usize, receiver: &LightSampleContext, drawn: Option<LightSample>) {
        let Some(drawn) = drawn else {
            self.pdf[lane] = 0.0;
            return;
        };
        self.direction.set(lane, drawn.direction.as_vec3());
        self.weight.set(lane, drawn.weight.as_vec3());
        self.pdf[lane] = drawn.pdf as f32;
        let reach = |source: RayOrigin| PathRays::END * (source.position() - receiver.position).length();
        self.t_max[lane] = drawn.source.map_or(f64::INFINITY, reach);
        self.primitive[lane] = drawn.primitive;
    }
}

impl Lights {
    /// Return whether f32 suffices for the choice of a light: there is one, or each of few lamps has a probability of
    /// at least a thousandth.
    pub fn choices_are_even(&self) -> bool {
        /// One over the probability.
        const RAREST: f32 = 1000.0;
        let is_even = |rarity: f32| rarity < RAREST || rarity == f32::INFINITY;
        let are_even = || self.lamps.iter().flatten().all(|lamp| is_even(lamp.rarity));
        match &self.choice {
            None => self.infinite.lights().len() <= 1,
            Some(Choice::Power(_)) => self.infinite.is_dark() && self.few_triangles.is_some() && are_even(),
            Some(Choice::Tree(_)) => false,
        }
    }

    /// Whether a choice among lights, or the light of one, depends on the normal of who asks.
    pub fn ask_for_normals(&self) -> bool {
        matches!(self.choice, Some(Choice::Tree(_))) || !self.infinite.is_dark()
    }

    /// The radiance of a sky that is the same everywhere and the only light.
    pub fn constant_sky(&self) -> Option<Rgb> {
        match (&self.choice, self.infinite.lights()) {
            (None, [sky]) => sky.constant_radiance(),
            _ => None,
        }
    }

    /// Draws light for points: of which light by `choice`, from where by `u`.
    pub fn draw_block(
        &self,
        level: Level,
        geometry: &Geometry,
        receivers: &ReceiverBlock<'_>,
        choice: &[f64; LANES],
        u: &[[f32; LANES]; 2],
        lights: &mut LightBlock,
    ) {
        let ReceiverBlock { surfaces, normal, .. } = *receivers;
        if let (true, Some(choices)) = (self.infinite.is_dark(), &self.choice) {
            if let Some(few) = &self.few_triangles {
                let mut lamps = LampLanes::NONE;
                choose_triangles(level, few, choice, &mut lamps, &mut lights.primitive);
                draw_lamps(level, surfaces, &lamps, u, lights);
                return self.shine(geometry, receivers, !0, lights);
            }
            let chosen = choices.sample_lanes(&receivers.places(), normal, choice);
            return self.draw_chosen(level, geometry, receivers, &chosen, u, lights);
        }
        let sky = self.constant_sky();
        if let Some(radiance) = sky {
            let LightBlock { direction, weight, pdf, t_max, primitive } = lights;
            draw_sky(level, radiance.as_vec3(), normal, u, direction, weight, pdf);
            (*t_max, *primitive) = ([f64::INFINITY; LANES], [Ray::NO_TRIANGLE; LANES]);
        }
        // The sky above a surface is drawn already.
        for lane in (0..surfaces.count).filter(|&lane| sky.is_none() || normal.get(lane) == Vec3::ZERO) {
            let (receiver, u) = (receivers.get(lane), [u[0][lane].into(), u[1][lane].into()]);
            lights.set(lane, &receiver, self.sample(geometry, &receiver, choice[lane], u));
        }
    }

    /// Draws light of one of few lights ([`Lights::few`]).
    #[allow(clippy::too_many_arguments)]
    pub fn draw_one_block(
        &self,
        one: u32,
        level: Level,
        geometry: &Geometry,
        receivers: &ReceiverBlock<'_>,
        choice: &[f64; LANES],
        u: &[[f32; LANES]; 2],
        lights: &mut LightBlock,
    ) {
        if !self.is_within(one) {
            for lane in 0..receivers.surfaces.count {
                let (receiver, u) = (receivers.get(lane), [u[0][lane].into(), u[1][lane].into()]);
                let drawn = self.sample_one(one, geometry, &receiver, &mut || choice[lane], u);
                lights.set(lane, &receiver, drawn);
            }
            return;
        }
        let (mut own, mut chosen) = (*u, [None; LANES]);
        for lane in 0..LANES {
            let (number, share, x) = self.one_within(one, u[0][lane].into());
            (own[0][lane], chosen[lane]) = (x as f32, Some((number, share)));
        }
        self.draw_chosen(level, geometry, receivers, &chosen, &own, lights);
    }

    /// Lamps that were drawn in some lanes shine by wavelength, if their emission goes by that.
    fn shine(&self, geometry: &Geometry, receivers: &ReceiverBlock<'_>, which: u32, lights: &mut LightBlock) {
        if !self.lamps.iter().flatten().any(|lamp| lamp.has_waves) {
            return;
        }
        for lane in (0..receivers.surfaces.count).filter(|lane| which >> lane & 1 == 1 && lights.pdf[*lane] > 0.0) {
            let emission = self.emission(geometry.locate(lights.primitive[lane]).0);
            if emission.needs().waves {
                let at = TexturePoint { waves: receivers.waves[lane], ..TexturePoint::NOWHERE };
                lights.weight.set(lane, lights.weight.get(lane) * emission.radiance.at(&at).as_vec3());
            }
        }
    }

    /// Draws light of lights within the scene, given by their numbers and the probabilities of these.
    fn draw_chosen(
        &self,
        level: Level,
        geometry: &Geometry,
        receivers: &ReceiverBlock<'_>,
        chosen: &[Option<(usize, f64)>; LANES],
        u: &[[f32; LANES]; 2],
        lights: &mut LightBlock,
    ) {
        let surfaces = receivers.surfaces;
        let mut lamps = LampLanes::NONE;
        let (mut triangles, mut spheres, mut others) = (0u32, 0u32, 0u32);
        for (lane, chosen) in chosen.iter().enumerate().take(surfaces.count) {
            // What is not chosen has no sides that shine.
            let Some((number, probability)) = *chosen else { continue };
            let Some(Some(lamp)) = self.lamps.get(number) else {
                others |= 1 << lane;
                continue;
            };
            lamps.set(lane, lamp, probability);
            lights.primitive[lane] = lamp.primitive;
            match lamp.form {
                Form::Triangle(_) => triangles |= 1 << lane,
                Form::Sphere(_) => spheres |= 1 << lane,
            }
        }
        if spheres == 0 {
            draw_lamps(level, surfaces, &lamps, u, lights);
        } else {
            let (mut of_spheres, mut distance, mut outside) = (LightBlock::NONE, [0.0; LANES], [0; LANES]);
            let LightBlock { direction, weight, pdf, .. } = &mut of_spheres;
            draw_spheres(level, &surfaces.position, &lamps, u, direction, weight, pdf, &mut distance, &mut outside);
            if triangles != 0 {
                draw_lamps(level, surfaces, &lamps, u, lights);
            }
            for lane in (0..surfaces.count).filter(|lane| triangles >> lane & 1 == 0) {
                lights.direction.set(lane, of_spheres.direction.get(lane));
                lights.weight.set(lane, of_spheres.weight.get(lane));
                lights.pdf[lane] = of_spheres.pdf[lane];
                lights.t_max[lane] = PathRays::END * f64::from(distance[lane]);
                others |= spheres & !outside[lane] & 1 << lane;
            }
        }
        self.shine(geometry, receivers, !others, lights);
        for lane in (0..surfaces.count).filter(|lane| others >> lane & 1 == 1) {
            let (receiver, u) = (receivers.get(lane), [u[0][lane].into(), u[1][lane].into()]);
            let drawn = chosen[lane].and_then(|(number, probability)| {
                Some(self.sample_within(number, geometry, &receiver, u)?.chosen(probability))
            });
            lights.set(lane, &receiver, drawn);
        }
    }
}

/// Draws light of triangles.
fn draw_lamps(
    level: Level,
    surfaces: &SurfaceBlock,
    lamps: &LampLanes,
    u: &[[f32; LANES]; 2],
    lights: &mut LightBlock,
) {
    let (mut way, mut distance) = (SingleLanes::ZERO, [0.0; LANES]);
    relative(level, &lamps.place, &surfaces.position, &mut way);
    let LightBlock { direction, weight, pdf, t_max, .. } = lights;
    draw_triangles(level, &way, &lamps.edges, lamps, u, direction, weight, pdf, &mut distance);
    for lane in 0..LANES {
        t_max[lane] = PathRays::END * f64::from(distance[lane]);
    }
}
