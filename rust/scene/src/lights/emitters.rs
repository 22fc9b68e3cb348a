//! Emission sampling over all lights of a scene, by power.

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

/// Distribution of emitted light over surfaces, points and infinite lights. For an infinite light the position is on a
/// rectangle perpendicular to the direction that contains the projection of the scene's box.
///
/// A light is selected by power, a position by area, and a direction by cosine (Dutré, Lafortune and Willems, "Monte
/// Carlo Light Tracing with Direct Computation of Pixel Intensities", 1993).
pub struct Emitters<'a> {
    pub(super) lights: &'a Lights,
    pub(super) geometry: &'a Geometry,
    /// Over the lights within the scene, followed by one entry for all infinite lights.
    pub(super) choice: AliasTable,
    /// Number of lights within the scene.
    pub(super) within: usize,
    /// The scene's box: its center, and half its size.
    pub(super) middle: DVec3,
    half: DVec3,
    /// Guiding of emission from surfaces and points.
    pub(super) aim: Aim,
}

/// Random numbers of an emission sample, each in [0, 1).
#[derive(Clone, Copy, Debug)]
pub struct EmissionNumbers {
    /// Selection of the light.
    pub choice: f64,
    /// Selection among the infinite lights.
    pub outside: f64,
    /// Position on the light; for infinite lights the direction.
    pub place: [f64; 2],
    /// Direction; for infinite lights the position on the rectangle.
    pub direction: [f64; 2],
}

impl<'a> Emitters<'a> {
    /// Builds the distribution for the lights of a scene in a region; `None` if no emitter can be sampled.
    pub fn new(lights: &'a Lights, geometry: &'a Geometry, region: &Region) -> Option<Self> {
        let half = (region.max - region.min).max(DVec3::ZERO) * 0.5;
        let mut powers: Vec<f64> = lights.strengths(geometry).iter().map(|one| one.power.min(MOST)).collect();
        let within = powers.len();
        // The mean projected area of a box over all directions is a quarter of its surface (Cauchy).
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

    /// Adds guiding of emission from surfaces and points.
    pub fn aimed(self, aim: Aim) -> Self {
        Self { aim, ..self }
    }

    /// Samples emission, at some wavelengths or as red, green and blue; `None` if the sample carries no light.
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

    /// Samples emission from a point light.
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

    /// Samples emission from a point light, from its own distribution or towards the guiding spheres.
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

    /// Position of a point light and its guiding cones, if there are any.
    pub(super) fn aim_of_point(&self, number: usize) -> Option<(DVec3, Cones<'_>)> {
        let Some(Place::Point(position)) = self.lights.inside[number].place() else { return None };
        self.aim.from(position).map(|cones| (position, cones))
    }

    /// Samples emission from a primitive that is not an instance.
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

    /// Samples emission from a surface point of a light, whose area density is given. The hit is that of a ray that
    /// arrives from distance 1.
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
        // The radiance that a ray back along it would see.
        let back = Ray::new(surface.position + direction, -direction);
        let radiance = luminous.sent(self.geometry, &back, &hit, surface, || waves.copied());
        let sides = sides.count();
        let ray = Ray { misses: [hit.primitive, Ray::NO_TRIANGLE], ..RayOrigin::new(surface).ray(direction) };
        let is_drawn = pdf > 0.0 && pdf < f64::INFINITY && cosine > 0.0;
        let own = cosine / (PI * sides);
        let towards = cones.as_ref().map_or(own, |cones| cones.density(direction, own));
        is_drawn.then(|| EmissionSample {
            ray,
            // Unguided directions are cosine-distributed, so the weight does not depend on the direction, to the last
            // digit.
            weight: radiance * if cones.is_some() { cosine / (towards * pdf) } else { PI * sides / pdf },
            pdf: EmissionPdf { place: pdf, direction: towards },
            normal,
            source: Source::Surface(light as u32),
            is_infinite: false,
        })
    }

    /// Samples emission from outside: a direction, and a position on a perpendicular rectangle that covers the box.
    fn of_infinite(&self, numbers: &EmissionNumbers, waves: Option<&Waves>) -> Option<EmissionSample> {
        let receiver = LightSampleContext { waves: waves.copied(), ..LightSampleContext::free(self.middle) };
        let chosen = self.lights.infinite.choose(numbers.outside);
        let drawn = self.lights.infinite.sample_of(chosen, &receiver, numbers.place)?;
        let frame = Frame::new(drawn.direction);
        let [across, other] = self.covered(&frame);
        let [x, y] = numbers.direction.map(|u| 2.0 * u - 1.0);
        // The origin is slightly in front of the box, so that the whole box is reached.
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

    /// Half the extents of the scene's projected box along both axes perpendicular to a direction.
    pub(super) fn covered(&self, frame: &Frame) -> [f64; 2] {
        [frame.tangent, frame.bitangent].map(|axis| axis.abs().dot(self.half))
    }
}

/// The reason why emission cannot be sampled from all lights, if there is one: an unbounded emitter, emitters in moving
/// or too many instances, or infinite lights on unbounded geometry.
pub fn not_drawn(lights: &Lights, geometry: &Geometry) -> Option<String> {
    let endless = |primitive: u32| geometry.shape(primitive).is_some_and(|shape| !shape.bounds().is_finite());
    (0..geometry.shapes() as u32).find_map(|shape| {
        if let Some(instances) = geometry.instances_of(shape) {
            let shines = instances.prototype().appearances().any(|(_, emission)| !emission.is_dark());
            let is_missing = shines && !lights.copied.has(shape);
            return is_missing
                .then(|| format!("shape {shape} is emissive in instances that move, nest or are too many"));
        }
        if !geometry.primitives_of(shape).any(endless) {
            None
        } else if lights.shines(shape) {
            Some(format!("shape {shape} is emissive and unbounded"))
        } else {
            let is_lit = !lights.infinite.is_dark();
            is_lit.then(|| format!("light from outside falls on shape {shape}, which is unbounded"))
        }
    })
}
