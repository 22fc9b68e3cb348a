//! Lamps that shine alike everywhere, prepared to be drawn in f32.

use super::Lights;
use super::choice::Choice;
use super::plain::{Figure, PlainLight};
use crate::Geometry;
use raywright_base::math::single::{choose, mask};
use raywright_base::math::{DVec3, LANES, SingleLanes, Vec3, VectorLanes};
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

/// All lamps of a scene, which are one or two triangles, in SoA layout; one stands twice.
#[derive(Clone, Copy, Debug)]
pub(super) struct FewTriangles {
    /// The first is chosen by numbers less than this.
    share: f64,
    place: [[f64; 2]; 3],
    edges: [[[f32; 2]; 3]; 2],
    radiance: [[f32; 2]; 3],
    sides: [[u32; 2]; 2],
    rarity: [f32; 2],
    primitive: [u32; 2],
}

impl FewTriangles {
    /// `None` if there are more, or others.
    fn new(lamps: &[Option<Lamp>]) -> Option<Self> {
        let edges = |lamp: &Lamp| match lamp.form {
            Form::Triangle(edges) => Some(edges),
            Form::Sphere(_) => None,
        };
        let all: Vec<&Lamp> = lamps.iter().map(Option::as_ref).collect::<Option<_>>()?;
        let chosen: Vec<_> = all.into_iter().filter(|lamp| lamp.rarity < f32::INFINITY).collect();
        let (both, share) = match chosen[..] {
            [one] => ([one; 2], 1.0),
            [first, second] => ([first, second], second.before),
            _ => return None,
        };
        let [Some(first), Some(second)] = both.map(edges) else { return None };
        Some(Self {
            share,
            place: [0, 1, 2].map(|axis| both.map(|lamp| lamp.place[axis])),
            edges: [0, 1].map(|edge| [0, 1, 2].map(|axis| [first[edge][axis], second[edge][axis]])),
            radiance: [0, 1, 2].map(|channel| both.map(|lamp| lamp.radiance[channel])),
            sides: [0, 1].map(|side| both.map(|lamp| lamp.sides[side])),
            rarity: both.map(|lamp| lamp.rarity),
            primitive: both.map(|lamp| lamp.primitive),
        })
    }
}

loops! {
    /// Puts into each lane the triangle of a choice. There is a loop for each column: one for all is not vectorized.
    pub(super) fn choose_triangles(
        few: &FewTriangles,
        choice: &[f64; LANES],
        lamps: &mut LampLanes,
        primitive: &mut [u32; LANES],
    ) {
        let mut is_first = [0; LANES];
        for i in 0..LANES {
            is_first[i] = mask(choice[i] < few.share);
        }
        for axis in 0..3 {
            let ([first, second], to) = (few.place[axis], lamps.place.axis_mut(axis));
            for i in 0..LANES {
                to[i] = if choice[i] < few.share { first } else { second };
            }
            choose_each(&few.radiance[axis], &is_first, &mut lamps.radiance.0[axis]);
            for edge in 0..2 {
                choose_each(&few.edges[edge][axis], &is_first, &mut lamps.edges[edge].0[axis]);
            }
        }
        for i in 0..LANES {
            let of = |[first, second]: [u32; 2]| first & is_first[i] | second & !is_first[i];
            (lamps.sides[0][i], lamps.sides[1][i]) = (of(few.sides[0]), of(few.sides[1]));
            primitive[i] = of(few.primitive);
        }
        choose_each(&few.rarity, &is_first, &mut lamps.rarity);
    }
}

#[inline(always)]
fn choose_each([first, second]: &[f32; 2], is_first: &[u32; LANES], to: &mut [f32; LANES]) {
    for i in 0..LANES {
        to[i] = choose(is_first[i], *first, *second);
    }
}

impl Lights {
    /// All lights within the scene, if they are one or two triangles. More are not chosen by their power.
    pub(super) fn few_triangles(&self) -> Option<FewTriangles> {
        let are_surfaces = self.copied.len() + self.inside.len() == 0;
        let by_power = matches!(self.choice, Some(Choice::Power(_)));
        (are_surfaces && by_power).then(|| FewTriangles::new(&self.lamps))?
    }

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
