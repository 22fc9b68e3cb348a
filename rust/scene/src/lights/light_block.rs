//! Light drawn for sixteen points of surfaces at a time, in f32.

use super::choice::Choice;
use super::plain::Figure;
use super::{LightContextLanes, LightSampleContext, Lights};
use crate::geometry::SurfaceBlock;
use crate::{Geometry, RayOrigin};
use raywright_base::math::single::{
    choose, choose_vector, cosine_hemisphere, greater, mask, sin_cos_quarters, to_world, uniform_triangle, upper_angle,
};
use raywright_base::math::{DVec3, LANES, PathRays, Ray, SingleLanes, Vec3, VectorLanes, select};
use raywright_base::simd::{Level, loops};
use raywright_optics::Rgb;
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

/// A triangle that shines alike everywhere.
#[derive(Clone, Copy, Debug)]
pub(super) struct TriangleLamp {
    corner: DVec3,
    /// From there to the other corners.
    edges: [Vec3; 2],
    radiance: Vec3,
    /// Whether the front shines, and the back: all bits or none.
    sides: [u32; 2],
    primitive: u32,
    /// One over its probability, and with what probability it is one of those before; only where lights are chosen by
    /// their power.
    rarity: f32,
    before: f64,
}

/// Lamps, a lane each, as seen from points of surfaces.
struct Lamps {
    /// The way to the first corner.
    corner: SingleLanes,
    edges: [SingleLanes; 2],
    radiance: SingleLanes,
    sides: [[u32; LANES]; 2],
    /// One over the probability of each.
    rarity: [f32; LANES],
}

/// A triangle as it is seen from a place, as [`super::SeenTriangle`] is, in f32.
struct TriangleFromPoint {
    edges: [Vec3; 2],
    corner: Vec3,
    /// Along the normal, twice the area long.
    area: Vec3,
    a: Vec3,
    b: Vec3,
    chord: Vec3,
    solid_angle: f32,
    /// Whether directions are drawn by solid angle rather than points by area.
    is_near: u32,
}

impl TriangleFromPoint {
    /// See [`super::SeenTriangle`]. Of a solid angle this small, f32 has three digits.
    const THIN: f32 = 1e-4;
    const DISTANT: f32 = 2.0;

    #[inline(always)]
    fn new(corner: Vec3, edges: [Vec3; 2]) -> Self {
        let area = edges[0].cross(edges[1]);
        let longest = greater(edges[0].dot(edges[0]), edges[1].dot(edges[1]));
        let [ka, kb, kc] = [corner, corner + edges[0], corner + edges[1]];
        let [la, lb, lc] = [ka.dot(ka).sqrt(), kb.dot(kb).sqrt(), kc.dot(kc).sqrt()];
        let [ia, ib, ic] = [1.0 / la, 1.0 / lb, 1.0 / lc];
        let [a, b, c] = [ka * ia, kb * ib, kc * ic];
        let determinant = corner.dot(area).abs() * ia * ib * ic;
        let rest = 1.0 + a.dot(b) + b.dot(c) + c.dot(a);
        let solid_angle = 2.0 * upper_angle(determinant, rest);
        let nearer = -edges[0].dot(ka + kb) * ia * ib / (la + lb);
        let chord = edges[0] * ib + corner * nearer;
        let is_near = mask(corner.dot(corner) <= Self::DISTANT * Self::DISTANT * longest)
            & mask(solid_angle >= Self::THIN)
            & mask(solid_angle < 7.0);
        Self { edges, corner, area, a, b, chord, solid_angle, is_near }
    }

    /// A direction of the triangle, drawn evenly.
    #[inline(always)]
    fn direction(&self, u: [f32; 2]) -> Vec3 {
        let Self { edges: [_, edge], a, b, chord, solid_angle, .. } = *self;
        let tangent = edge - a * a.dot(edge);
        let tangent = tangent * (1.0 / tangent.dot(tangent).sqrt());
        let [sin, cos] = sin_cos_quarters(solid_angle * u[0] * FRAC_1_PI);
        let along = sin * (1.0 + a.dot(b));
        let against = cos * a.dot(chord.cross(tangent)).abs() - sin * chord.dot(tangent);
        let length = along * along + against * against;
        let step = (tangent * against - a * along) * (2.0 * along / length);
        let arc = choose_vector(mask(length > 0.0), step - chord, -chord);
        let height = 0.5 * arc.dot(arc) * u[1];
        let side = arc - b * b.dot(arc);
        let square = side.dot(side);
        let side = side * choose(mask(square > 0.0), 1.0 / square.sqrt(), 0.0);
        b * (1.0 - height) + side * greater(height * (2.0 - height), 0.0).sqrt()
    }

    /// A direction that is drawn, the distance of the triangle there, and the inverse of the density.
    #[inline(always)]
    fn sample(&self, u: [f32; 2]) -> (Vec3, f32, f32) {
        let Self { edges: [first, second], corner, area, solid_angle, is_near, .. } = *self;
        let near = self.direction(u);
        let near_distance = corner.dot(area) / near.dot(area);
        let [x, y] = uniform_triangle(u);
        let far = corner + first * x + second * y;
        let square = far.dot(far);
        let inverse = 1.0 / square.sqrt();
        let far = far * inverse;
        let direction = choose_vector(is_near, near, far);
        let distance = choose(is_near, near_distance, square * inverse);
        let spread = choose(is_near, solid_angle, 0.5 * far.dot(area).abs() * (inverse * inverse));
        (direction, distance, spread)
    }
}

/// So few lamps are spread over lanes one by one, which takes less time than to look one up for each lane.
const FEW_LAMPS: usize = 4;

loops! {
    /// Puts a lamp into the lanes whose choice is it or one that follows, over those before.
    fn spread(
        lamp: &TriangleLamp,
        choice: &[f64; LANES],
        corner: &mut VectorLanes,
        lamps: &mut Lamps,
        primitive: &mut [u32; LANES],
    ) {
        let mut is_here = [0; LANES];
        for i in 0..LANES {
            corner.set(i, select(choice[i] >= lamp.before, lamp.corner, corner.get(i)));
            is_here[i] = mask(choice[i] >= lamp.before);
        }
        for i in 0..LANES {
            let here = is_here[i];
            lamps.edges[0].set(i, choose_vector(here, lamp.edges[0], lamps.edges[0].get(i)));
            lamps.edges[1].set(i, choose_vector(here, lamp.edges[1], lamps.edges[1].get(i)));
            lamps.radiance.set(i, choose_vector(here, lamp.radiance, lamps.radiance.get(i)));
            lamps.sides[0][i] = lamp.sides[0] & here | lamps.sides[0][i] & !here;
            lamps.sides[1][i] = lamp.sides[1] & here | lamps.sides[1][i] & !here;
            lamps.rarity[i] = choose(here, lamp.rarity, lamps.rarity[i]);
            primitive[i] = lamp.primitive & here | primitive[i] & !here;
        }
    }
}

loops! {
    /// The ways from points to lamps.
    fn relative(corner: &VectorLanes, position: &VectorLanes, way: &mut SingleLanes) {
        for i in 0..LANES {
            way.set(i, (corner.get(i) - position.get(i)).as_vec3());
        }
    }
}

loops! {
    /// Draws light of lamps.
    fn draw(
        lamps: &Lamps,
        u: &[[f32; LANES]; 2],
        direction: &mut SingleLanes,
        weight: &mut SingleLanes,
        pdf: &mut [f32; LANES],
        distance: &mut [f32; LANES],
    ) {
        for i in 0..LANES {
            let seen = TriangleFromPoint::new(lamps.corner.get(i), [lamps.edges[0].get(i), lamps.edges[1].get(i)]);
            let (towards, length, spread) = seen.sample([u[0][i], u[1][i]]);
            let spread = spread * lamps.rarity[i];
            let height = -lamps.corner.get(i).dot(seen.area);
            let shines = lamps.sides[0][i] & mask(height > 0.0) | lamps.sides[1][i] & mask(height < 0.0);
            // Also false where the distance is 0 and the direction NaN.
            let is_lit = shines & mask(spread > 0.0) & mask(spread < f32::INFINITY) & mask(length > 0.0);
            direction.set(i, towards);
            weight.set(i, lamps.radiance.get(i) * spread);
            pdf[i] = choose(is_lit, 1.0 / spread, 0.0);
            distance[i] = length;
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

impl LightBlock {
    /// No light.
    pub const NONE: Self = Self {
        direction: SingleLanes::ZERO,
        weight: SingleLanes::ZERO,
        pdf: [0.0; LANES],
        t_max: [f64::INFINITY; LANES],
        primitive: [Ray::NO_TRIANGLE; LANES],
    };
}

impl Lights {
    /// All lights within the scene as triangles that shine alike everywhere, if they are such, and few enough to be
    /// kept.
    pub(super) fn triangle_lamps(&self, geometry: &Geometry) -> Vec<TriangleLamp> {
        let numbers = self.surfaces.len() + self.copied.len() + self.inside.len();
        let lamp = |number: usize| {
            let light = self.plain(geometry, number)?;
            let Figure::Triangle { corners: [a, b, c], .. } = light.figure else { return None };
            Some(TriangleLamp {
                corner: a,
                edges: [(b - a).as_vec3(), (c - a).as_vec3()],
                radiance: light.radiance.as_vec3(),
                sides: light.sides.map(mask),
                primitive: light.primitive,
                rarity: 1.0,
                before: 0.0,
            })
        };
        if numbers > self.kept.len() {
            return Vec::new();
        }
        let Some(mut lamps) = (0..numbers).map(lamp).collect::<Option<Vec<_>>>() else { return Vec::new() };
        if let Some(Choice::Power(table)) = &self.choice {
            let mut before = 0.0;
            for (number, lamp) in lamps.iter_mut().enumerate() {
                let probability = table.probability(number);
                (lamp.rarity, lamp.before) = ((1.0 / probability) as f32, before);
                before += probability;
            }
        }
        lamps
    }

    /// Return whether f32 suffices for the choice of a light: there is one, or each of few lamps has a probability of
    /// at least a thousandth.
    pub fn choices_are_even(&self) -> bool {
        /// One over the probability.
        const RAREST: f32 = 1000.0;
        let are_even = || self.lamps.iter().all(|lamp| lamp.rarity < RAREST || lamp.rarity == f32::INFINITY);
        match &self.choice {
            None => self.infinite.lights().len() <= 1,
            Some(Choice::Power(_)) => {
                self.infinite.is_dark() && !self.lamps.is_empty() && self.lamps.len() <= FEW_LAMPS && are_even()
            }
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

    /// Draws light for points of surfaces that reflect on the side that they were met on: of which light by `choice`,
    /// from where by `u`.
    pub fn draw_block(
        &self,
        level: Level,
        geometry: &Geometry,
        surfaces: &SurfaceBlock,
        choice: &[f64; LANES],
        u: &[[f32; LANES]; 2],
        lights: &mut LightBlock,
    ) {
        if let (true, Some(choices)) = (self.infinite.is_dark() && !self.lamps.is_empty(), &self.choice) {
            return self.draw_lamps(level, choices, surfaces, choice, u, lights);
        }
        if let Some(radiance) = self.constant_sky() {
            let LightBlock { direction, weight, pdf, t_max, primitive } = lights;
            draw_sky(level, radiance.as_vec3(), &surfaces.normal, u, direction, weight, pdf);
            (*t_max, *primitive) = ([f64::INFINITY; LANES], [Ray::NO_TRIANGLE; LANES]);
            return;
        }
        for lane in 0..surfaces.count {
            let receiver = receiver(surfaces, lane);
            let u = [f64::from(u[0][lane]), f64::from(u[1][lane])];
            let Some(sample) = self.sample(geometry, &receiver, choice[lane], u) else {
                lights.pdf[lane] = 0.0;
                continue;
            };
            lights.direction.set(lane, sample.direction.as_vec3());
            lights.weight.set(lane, sample.weight.as_vec3());
            lights.pdf[lane] = sample.pdf as f32;
            let source = |source: RayOrigin| PathRays::END * (source.position() - receiver.position).length();
            lights.t_max[lane] = sample.source.map_or(f64::INFINITY, source);
            lights.primitive[lane] = sample.primitive;
        }
    }

    fn draw_lamps(
        &self,
        level: Level,
        choices: &Choice,
        surfaces: &SurfaceBlock,
        choice: &[f64; LANES],
        u: &[[f32; LANES]; 2],
        lights: &mut LightBlock,
    ) {
        let (mut corner, zero) = (VectorLanes::ZERO, SingleLanes::ZERO);
        let mut lamps =
            Lamps { corner: zero, edges: [zero; 2], radiance: zero, sides: [[0; LANES]; 2], rarity: [1.0; LANES] };
        if matches!(choices, Choice::Power(_)) && self.lamps.len() <= FEW_LAMPS {
            for lamp in self.lamps.iter().filter(|lamp| lamp.rarity < f32::INFINITY) {
                spread(level, lamp, choice, &mut corner, &mut lamps, &mut lights.primitive);
            }
        } else {
            let mut chosen = [None; LANES];
            let mut receivers = LightContextLanes::NONE;
            for lane in 0..LANES {
                receivers.set(lane, &receiver(surfaces, lane));
            }
            choices.sample_lanes(level, &receivers, choice, &mut chosen);
            for (lane, chosen) in chosen.into_iter().enumerate() {
                // What is not chosen has no sides that shine.
                let Some((number, probability)) = chosen else { continue };
                let lamp = &self.lamps[number];
                corner.set(lane, lamp.corner);
                lamps.edges[0].set(lane, lamp.edges[0]);
                lamps.edges[1].set(lane, lamp.edges[1]);
                lamps.radiance.set(lane, lamp.radiance);
                (lamps.sides[0][lane], lamps.sides[1][lane]) = (lamp.sides[0], lamp.sides[1]);
                (lamps.rarity[lane], lights.primitive[lane]) = ((1.0 / probability) as f32, lamp.primitive);
            }
        }
        relative(level, &corner, &surfaces.position, &mut lamps.corner);
        let mut distance = [0.0; LANES];
        draw(level, &lamps, u, &mut lights.direction, &mut lights.weight, &mut lights.pdf, &mut distance);
        for lane in 0..LANES {
            lights.t_max[lane] = PathRays::END * f64::from(distance[lane]);
        }
    }
}

/// Who asks for light, a lane each.
#[inline]
fn receiver(surfaces: &SurfaceBlock, lane: usize) -> LightSampleContext {
    let normal = surfaces.normal.get(lane).as_dvec3();
    LightSampleContext { position: surfaces.position.get(lane), normal, waves: None }
}
