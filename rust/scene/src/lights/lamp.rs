//! Lamps that shine alike everywhere, prepared to be drawn in f32.

use super::Lights;
use super::choice::Choice;
use super::plain::{Figure, PlainLight};
use crate::Geometry;
use raywright_base::math::single::{choose, choose_vector, mask};
use raywright_base::math::{DVec3, LANES, SingleLanes, Vec3, VectorLanes, select};
use raywright_base::simd::loops;

/// A triangle or a sphere that shines alike everywhere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lamp {
    /// The first corner of a triangle, or the center of a sphere.
    pub place: DVec3,
    pub form: Form,
    pub radiance: Vec3,
    /// True if the radiance is that times the emission at the wavelengths of a path.
    pub has_waves: bool,
    /// Whether the front shines, and the back: all bits or none.
    pub sides: [u32; 2],
    pub primitive: u32,
    /// One over its probability, and with what probability it is one of those before; only where lights are chosen by
    /// their power.
    pub rarity: f32,
    pub before: f64,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Form {
    /// From the first corner to the others.
    Triangle([Vec3; 2]),
    /// The radius.
    Sphere(f64),
}

/// Lamps, a lane each.
pub(super) struct LampLanes {
    pub place: VectorLanes,
    /// Of triangles.
    pub edges: [SingleLanes; 2],
    /// Of spheres.
    pub radius: [f64; LANES],
    pub radiance: SingleLanes,
    pub sides: [[u32; LANES]; 2],
    /// One over the probability of each.
    pub rarity: [f32; LANES],
}

impl LampLanes {
    /// None, which shine to no side. All bytes are zero: other constants would be copied at each use.
    pub const NONE: Self = Self {
        place: VectorLanes::ZERO,
        edges: [SingleLanes::ZERO; 2],
        radius: [0.0; LANES],
        radiance: SingleLanes::ZERO,
        sides: [[0; LANES]; 2],
        rarity: [0.0; LANES],
    };

    /// Puts a lamp, drawn with a probability, into a lane.
    #[inline]
    pub fn set(&mut self, lane: usize, lamp: &Lamp, probability: f64) {
        self.place.set(lane, lamp.place);
        match lamp.form {
            Form::Triangle([first, second]) => {
                self.edges[0].set(lane, first);
                self.edges[1].set(lane, second);
            }
            Form::Sphere(radius) => self.radius[lane] = radius,
        }
        self.radiance.set(lane, lamp.radiance);
        (self.sides[0][lane], self.sides[1][lane]) = (lamp.sides[0], lamp.sides[1]);
        self.rarity[lane] = (1.0 / probability) as f32;
    }
}

/// So few triangles are spread over lanes one by one, which takes less time than to look one up for each lane.
pub(super) const FEW_LAMPS: usize = 4;

loops! {
    /// Puts a triangle into the lanes whose choice is it or one that follows, over those before.
    pub(super) fn spread(
        lamp: &Lamp,
        edges: &[Vec3; 2],
        choice: &[f64; LANES],
        lamps: &mut LampLanes,
        primitive: &mut [u32; LANES],
    ) {
        let mut is_here = [0; LANES];
        for i in 0..LANES {
            lamps.place.set(i, select(choice[i] >= lamp.before, lamp.place, lamps.place.get(i)));
            is_here[i] = mask(choice[i] >= lamp.before);
        }
        for i in 0..LANES {
            let here = is_here[i];
            lamps.edges[0].set(i, choose_vector(here, edges[0], lamps.edges[0].get(i)));
            lamps.edges[1].set(i, choose_vector(here, edges[1], lamps.edges[1].get(i)));
            lamps.radiance.set(i, choose_vector(here, lamp.radiance, lamps.radiance.get(i)));
            lamps.sides[0][i] = lamp.sides[0] & here | lamps.sides[0][i] & !here;
            lamps.sides[1][i] = lamp.sides[1] & here | lamps.sides[1][i] & !here;
            lamps.rarity[i] = choose(here, lamp.rarity, lamps.rarity[i]);
            primitive[i] = lamp.primitive & here | primitive[i] & !here;
        }
    }
}

impl Lights {
    /// Of all surfaces that shine, those that do so alike everywhere, by number; none if there are too many to keep.
    pub(super) fn lamps(&self, geometry: &Geometry) -> Vec<Option<Lamp>> {
        if self.surfaces.len() > self.kept.len() {
            return Vec::new();
        }
        let mut before = 0.0;
        let lamp = |number: usize| {
            let probability = match &self.choice {
                Some(Choice::Power(table)) => table.probability(number),
                _ => 1.0,
            };
            let (rarity, start) = ((1.0 / probability) as f32, before);
            before += probability;
            let plain = self.plain(geometry, number);
            let by_waves = || {
                let primitive = self.surfaces[number];
                PlainLight::by_waves(geometry, &self.luminous(geometry, primitive), primitive)
            };
            let (has_waves, light) = (plain.is_none(), plain.or_else(by_waves)?);
            let (place, form) = match light.figure {
                Figure::Triangle { corners: [a, b, c] } => (a, Form::Triangle([(b - a).as_vec3(), (c - a).as_vec3()])),
                Figure::Ball { center, radius } => (center, Form::Sphere(radius)),
            };
            let (radiance, sides) = (light.radiance.as_vec3(), light.sides.map(mask));
            let primitive = light.primitive;
            Some(Lamp { place, form, radiance, has_waves, sides, primitive, rarity, before: start })
        };
        (0..self.surfaces.len()).map(lamp).collect()
    }
}
