//! Light that sets out from the lights of a scene, drawn by their power.

use super::aim::Cones;
use super::choice::MOST;
use super::emission_sample::PointEmission;
use super::emission_sample::{EmissionPdf, EmissionSample, Source};
use super::light::Place;
use super::{Aim, LightSampleContext, Lights, Luminous, Reach, Sides};
use crate::{Geometry, RayOrigin, SurfacePoint};
use raywright_base::math::{DVec3, Frame, Hit, Ray, Region};
use raywright_base::sampling::AliasTable;
use raywright_base::sampling::warp::{cosine_hemisphere, uniform_triangle};
use raywright_optics::spectra::Waves;
use std::f64::consts::PI;

/// What light that sets out is drawn from: surfaces, points, and the plane across any direction that light comes from
/// outside along, of which a rectangle is taken that holds all that the scene's box covers.
///
/// A light is chosen by its power, a place on it by area, and a direction by the cosine (Dutré, Lafortune and Willems,
/// "Monte Carlo Light Tracing with Direct Computation of Pixel Intensities", 1993).
pub struct Emitters<'a> {
    pub(super) lights: &'a Lights,
    pub(super) geometry: &'a Geometry,
    /// Over the lights within the scene, and after them all that comes from outside.
    pub(super) choice: AliasTable,
    /// How many are within.
    pub(super) within: usize,
    /// The scene's box: its middle, and half its size.
    pub(super) middle: DVec3,
    half: DVec3,
    /// What light from surfaces and points is aimed at.
    pub(super) aim: Aim,
}

/// The numbers that light that sets out is drawn by, each in [0, 1).
#[derive(Clone, Copy, Debug)]
pub struct EmissionNumbers {
    /// Which light.
    pub choice: f64,
    /// Which of the lights outside.
    pub outside: f64,
    /// Where on it; of light from outside, along which direction.
    pub place: [f64; 2],
    /// Into which direction; of light from outside, where across it.
    pub direction: [f64; 2],
}

impl<'a> Emitters<'a> {
    /// Those of a scene of these lights that lies in a region; `None` if nothing shines that could be drawn.
    pub fn new(lights: &'a Lights, geometry: &'a Geometry, region: &Region) -> Option<Self> {
        let half = (region.max - region.min).max(DVec3::ZERO) * 0.5;
        let mut powers: Vec<f64> = lights.strengths(geometry).iter().map(|one| one.power.min(MOST)).collect();
        let within = powers.len();
        // What a box covers across a direction, in the mean over all of them: a quarter of its surface (Cauchy).
        let covered = 2.0 * (half.x * half.y + half.y * half.z + half.z * half.x);
        let from_outside = lights.infinite.lights().iter().map(|light| match light.reach() {
            Reach::Infinite { flux, .. } => flux * covered,
            Reach::Finite { .. } => 0.0,
        });
        let from_outside = from_outside.sum::<f64>();
        powers.push(if from_outside.is_finite() { from_outside.min(MOST) } else { 0.0 });
        let middle = region.min + half;
        Some(Self { lights, geometry, choice: AliasTable::new(&powers)?, within, middle, half, aim: Aim::default() })
    }

    /// The same, where light from surfaces and points is aimed.
    pub fn aimed(self, aim: Aim) -> Self {
        Self { aim, ..self }
    }

    /// Draws light that sets out, at some wavelengths or as red, green and blue; `None` if the draw gives none.
    pub fn sample(&self, numbers: &EmissionNumbers, waves: Option<&Waves>) -> Option<EmissionSample> {
        let chosen = self.choice.sample(numbers.choice);
        let probability = self.choice.probability(chosen);
        let drawn = if chosen == self.within {
            self.of_infinite(numbers, waves)?
        } else if let Some(&primitive) = self.lights.surfaces.get(chosen) {
            let luminous = self.lights.luminous(self.geometry, primitive);
            self.of_primitive(&luminous, chosen, primitive, (numbers, waves))?
        } else {
            let number = chosen - self.lights.surfaces.len();
            match number.checked_sub(self.lights.copied.len()) {
                None => {
                    let (luminous, surface, hit, pdf) =
                        self.lights.copied.place(number, self.geometry, numbers.place)?;
                    self.of_surface(&luminous, (chosen, &surface), hit, pdf, (numbers.direction, waves))?
                }
                Some(number) => self.of_point(number, numbers, waves)?,
            }
        };
        let weight = drawn.weight / probability;
        let pdf = EmissionPdf { place: drawn.pdf.place * probability, ..drawn.pdf };
        let is_any = !weight.is_black() && weight.is_radiance();
        is_any.then_some(EmissionSample { weight, pdf, ..drawn })
    }

    /// From a light that is a single point.
    fn of_point(&self, number: usize, numbers: &EmissionNumbers, waves: Option<&Waves>) -> Option<EmissionSample> {
        let drawn = self.aimed_point(number, numbers.direction, waves)?;
        Some(EmissionSample {
            ray: Ray::new(drawn.position, drawn.direction),
            weight: drawn.weight,
            pdf: EmissionPdf { place: 1.0, direction: drawn.pdf },
            normal: DVec3::ZERO,
            source: Source::Point(number as u32),
            is_infinite: false,
        })
    }

    /// Light from a point, drawn by how it shines or by what is aimed at from there.
    fn aimed_point(&self, number: usize, [u, v]: [f64; 2], waves: Option<&Waves>) -> Option<PointEmission> {
        let light = &self.lights.inside[number];
        let Some((position, cones)) = self.aim_of_point(number) else { return light.sample_emission_at([u, v], waves) };
        let share = cones.share();
        let (direction, intensity, own) = if u < share {
            let direction = cones.sample([u / share, v]);
            (direction, light.intensity_towards(direction, waves), light.emission_pdf(direction))
        } else {
            let drawn = light.sample_emission_at([(u - share) / (1.0 - share), v], waves)?;
            (drawn.direction, drawn.weight * drawn.pdf, drawn.pdf)
        };
        let pdf = cones.density(direction, own);
        Some(PointEmission { position, direction, weight: intensity / pdf, pdf })
    }

    /// What is aimed at from a light that is a point, and that.
    pub(super) fn aim_of_point(&self, number: usize) -> Option<(DVec3, Cones<'_>)> {
        let Some(Place::Point(position)) = self.lights.inside[number].place() else { return None };
        self.aim.from(position).map(|cones| (position, cones))
    }

    /// From a primitive of the scene that is no instance.
    fn of_primitive(
        &self,
        luminous: &Luminous,
        light: usize,
        primitive: u32,
        (numbers, waves): (&EmissionNumbers, Option<&Waves>),
    ) -> Option<EmissionSample> {
        let (surface, uv, pdf) = match self.geometry.shape(primitive) {
            Some(shape) => {
                let drawn = shape.sample(numbers.place)?;
                (self.geometry.on_shape(primitive, &drawn.point.site()), drawn.point.uv, drawn.pdf)
            }
            None => {
                let uv = uniform_triangle(numbers.place);
                (self.geometry.on_triangle(primitive, uv), uv, 1.0 / self.geometry.area(primitive))
            }
        };
        let hit = Hit { t: 1.0, uv, primitive, inner: 0 };
        self.of_surface(luminous, (light, &surface), hit, pdf, (numbers.direction, waves))
    }

    /// From a point of a surface, a light of this number, that was drawn with a density, by area; the hit is that of a
    /// ray that meets it from at distance 1.
    fn of_surface(
        &self,
        luminous: &Luminous,
        (light, surface): (usize, &SurfacePoint),
        hit: Hit,
        pdf: f64,
        ([u, v], waves): ([f64; 2], Option<&Waves>),
    ) -> Option<EmissionSample> {
        let sides = luminous.emission.sides;
        let cones = self.aim.from(surface.position);
        let share = cones.as_ref().map_or(0.0, Cones::share);
        let (normal, direction, cosine) = match &cones {
            Some(cones) if u < share => {
                let direction = cones.sample([u / share, v]);
                let towards = surface.normal.dot(direction);
                let normal = match sides {
                    Sides::Front => surface.normal,
                    Sides::Back => -surface.normal,
                    Sides::Both => surface.normal * 1f64.copysign(towards),
                };
                (normal, direction, normal.dot(direction))
            }
            _ => {
                let u = (u - share) / (1.0 - share);
                let (normal, u) = match sides {
                    Sides::Front => (surface.normal, u),
                    Sides::Back => (-surface.normal, u),
                    Sides::Both if u < 0.5 => (surface.normal, 2.0 * u),
                    Sides::Both => (-surface.normal, 2.0 * u - 1.0),
                };
                let local = cosine_hemisphere([u, v]);
                (normal, Frame::new(normal).to_world(local), local.z)
            }
        };
        // What a ray back along it would see.
        let back = Ray::new(surface.position + direction, -direction);
        let radiance = luminous.sent(self.geometry, &back, &hit, surface, || waves.copied());
        let sides = sides.count();
        let ray = Ray { misses: [hit.primitive, Ray::NO_TRIANGLE], ..RayOrigin::new(surface).ray(direction) };
        let is_drawn = pdf > 0.0 && pdf < f64::INFINITY && cosine > 0.0;
        let own = cosine / (PI * sides);
        let towards = cones.as_ref().map_or(own, |cones| cones.density(direction, own));
        is_drawn.then(|| EmissionSample {
            ray,
            // What is not aimed is worth the same in all directions, to the last digit.
            weight: radiance * if cones.is_some() { cosine / (towards * pdf) } else { PI * sides / pdf },
            pdf: EmissionPdf { place: pdf, direction: towards },
            normal,
            source: Source::Surface(light as u32),
            is_infinite: false,
        })
    }

    /// From outside: a direction, and a place on a rectangle across it from which all of the box is reached.
    fn of_infinite(&self, numbers: &EmissionNumbers, waves: Option<&Waves>) -> Option<EmissionSample> {
        let receiver = LightSampleContext { waves: waves.copied(), ..LightSampleContext::free(self.middle) };
        let chosen = self.lights.infinite.choose(numbers.outside);
        let drawn = self.lights.infinite.sample_of(chosen, &receiver, numbers.place)?;
        let frame = Frame::new(drawn.direction);
        let [across, other] = self.covered(&frame);
        let [x, y] = numbers.direction.map(|u| 2.0 * u - 1.0);
        // A little before the box, so that nothing of it is left out.
        let back = drawn.direction.abs().dot(self.half) + 0.01 * self.half.length();
        let origin =
            self.middle + frame.tangent * (across * x) + frame.bitangent * (other * y) + drawn.direction * back;
        let area = 4.0 * across * other;
        (area > 0.0).then(|| EmissionSample {
            ray: Ray::new(origin, -drawn.direction),
            weight: drawn.weight * area,
            pdf: EmissionPdf { place: 1.0 / area, direction: drawn.pdf },
            normal: DVec3::ZERO,
            source: if drawn.pdf == f64::INFINITY { Source::Direction(chosen as u32) } else { Source::Infinite },
            is_infinite: true,
        })
    }

    /// Half of what the scene's box covers along the two axes across a direction.
    pub(super) fn covered(&self, frame: &Frame) -> [f64; 2] {
        [frame.tangent, frame.bitangent].map(|axis| axis.abs().dot(self.half))
    }
}

/// Why the light of a scene cannot all be drawn as it sets out, if so: what shines has no end, moves within instances
/// or is in too many of them, or light from outside falls on what has no end.
pub fn not_drawn(lights: &Lights, geometry: &Geometry) -> Option<String> {
    let endless = |primitive: u32| geometry.shape(primitive).is_some_and(|shape| !shape.bounds().is_finite());
    (0..geometry.shapes() as u32).find_map(|shape| {
        if let Some(instances) = geometry.instances_of(shape) {
            let shines = instances.prototype().appearances().any(|(_, emission)| !emission.is_dark());
            let is_missing = shines && !lights.copied.has(shape);
            return is_missing.then(|| format!("shape {shape} shines in instances that move, nest or are too many"));
        }
        if !geometry.primitives_of(shape).any(endless) {
            None
        } else if lights.shines(shape) {
            Some(format!("shape {shape} shines and has no end"))
        } else {
            let is_lit = !lights.infinite.is_dark();
            is_lit.then(|| format!("light from outside falls on shape {shape}, which has no end"))
        }
    })
}
