//! The lights of a scene, and the selection among them.

mod aim;
mod bounds;
mod choice;
mod constant;
mod departures;
mod directional;
mod emission_sample;
mod emitters;
mod few_lights;
mod infinite;
mod instanced;
mod lamp;
mod light;
mod light_block;
mod light_sample;
mod light_sample_context;
mod light_tree;
mod luminous;
mod map;
mod picture;
mod plain;
mod point;
mod projector;
mod pyramid;
pub mod sky;
mod sphere_block;
mod spot;
mod surface;
#[cfg(test)]
mod tests;
mod triangle;
mod triangle_block;
mod waved;
mod wide_bounds;

pub use aim::Aim;
pub use bounds::LightBounds;
pub use constant::ConstantEnvironment;
pub use departures::EmissionDensity;
pub use directional::DirectionalLight;
pub use emission_sample::{EmissionPdf, EmissionSample, PointEmission, Source};
pub use emitters::{EmissionNumbers, Emitters, not_drawn};
pub use light::{Light, Place, Reach};
pub use light_block::{LightBlock, ReceiverBlock};
pub use light_sample::LightSample;
pub use light_sample_context::LightSampleContext;
pub use light_tree::LightTree;
pub use map::EnvironmentMap;
pub use picture::Picture;
pub use point::PointLight;
pub use projector::Projector;
pub use sky::SunSky;
pub use spot::{Profile, SpotLight};
pub use triangle::SeenTriangle;
pub use waved::Waved;

use super::materials::Material;
use super::textures::TexturePoint;
use super::{Emission, Geometry, Sides};
use choice::{Choice, Strength};
use few_lights::Few;
use infinite::InfiniteLights;
use instanced::Copied;
use lamp::{FewTriangles, Lamp};
use luminous::{Luminous, is_open};
use plain::PlainLight;
use raywright_accel::Primitives;
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use std::sync::Arc;

/// The lights of a scene: emissive surfaces, other lights within it, and infinite lights.
///
/// Lights within the scene are numbered: emissive primitives shape by shape, then those in instances of prototypes,
/// then lights that are not surfaces. A light is selected by power or, if there are many, by its estimated contribution
/// to the receiver.
#[derive(Debug)]
pub struct Lights {
    /// Emission of each shape, and whether it is not zero.
    emission: Vec<Emission>,
    shines: Vec<bool>,
    /// Materials of emissive shapes that rays may pass straight through; empty if there are no such shapes.
    open: Vec<Option<Arc<dyn Material>>>,
    /// For each shape, the light number of its first primitive; undefined for a dark shape.
    first: Vec<u32>,
    /// The emissive primitives.
    surfaces: Vec<u32>,
    copied: Copied,
    inside: Vec<Arc<dyn Light>>,
    /// `None` if no light within the scene emits.
    choice: Option<Choice>,
    infinite: InfiniteLights,
    few: Few,
    /// Precomputed data of each emissive primitive, if it is a triangle or sphere of uniform emission; empty if there
    /// are more than [`Lights::KEPT`].
    kept: Vec<Option<PlainLight>>,
    /// The same prepared for f32, and once more if they are few.
    lamps: Vec<Option<Lamp>>,
    few_triangles: Option<FewTriangles>,
}

impl Lights {
    /// Maximum number of precomputed emitters: 2/3 of a megabyte.
    const KEPT: usize = 1 << 12;

    /// Numbers the lights: the emission of each shape of a geometry with these materials, and lights that are not
    /// surfaces.
    pub(super) fn new(
        geometry: &Geometry,
        materials: &[Arc<dyn Material>],
        emission: Vec<Emission>,
        others: Vec<Arc<dyn Light>>,
    ) -> Self {
        let open = |(material, emission): (&Arc<dyn Material>, &Emission)| {
            (!emission.is_dark() && is_open(&**material)).then(|| Arc::clone(material))
        };
        let mut open: Vec<_> = materials.iter().zip(&emission).map(open).collect();
        if open.iter().all(Option::is_none) {
            open = Vec::new();
        }
        let luminous = |shape: u32| luminous(&emission, &open, shape);
        let (mut first, mut surfaces, mut strengths) = (Vec::new(), Vec::new(), Vec::new());
        let mut pairs = Vec::new();
        for shape in 0..emission.len() as u32 {
            first.push(surfaces.len() as u32);
            if !emission[shape as usize].is_dark() && geometry.instances_of(shape).is_none() {
                if geometry.primitives_of(shape).len() == 2 {
                    pairs.push(surfaces.len() as u32);
                }
                for primitive in geometry.primitives_of(shape) {
                    surfaces.push(primitive);
                    strengths.push(Self::of_primitive(geometry, primitive, &luminous(shape)));
                }
            }
        }
        let (copied, of_copies) = Copied::new(geometry);
        strengths.extend(of_copies);
        let (mut inside, mut infinite) = (Vec::new(), Vec::new());
        for light in others {
            match light.reach() {
                Reach::Finite { power, bounds } => {
                    strengths.push(Strength { power, bounds });
                    inside.push(light);
                }
                Reach::Infinite { flux, spread } => infinite.push((light, flux, spread)),
            }
        }
        let choice = Choice::new(&strengths);
        let infinite = InfiniteLights::new(infinite, choice.is_some());
        let few = Few::new(&strengths, &pairs, infinite.lights().len());
        let few_surfaces = if surfaces.len() <= Self::KEPT { surfaces.as_slice() } else { &[] };
        let plain = |&primitive: &u32| PlainLight::new(geometry, &luminous(geometry.locate(primitive).0), primitive);
        let kept = few_surfaces.iter().map(plain).collect();
        let shines = emission.iter().map(|emission| !emission.is_dark()).collect();
        let mut all = Self {
            emission,
            shines,
            open,
            first,
            surfaces,
            copied,
            inside,
            choice,
            infinite,
            few,
            kept,
            lamps: Vec::new(),
            few_triangles: None,
        };
        all.lamps = all.lamps(geometry);
        all.few_triangles = all.few_triangles();
        all
    }

    /// Strength of a primitive. A primitive that rays cannot hit has none, and neither has an unbounded one, because it
    /// has no uniform distribution over its area. Only BSDF sampling finds the latter.
    fn of_primitive(geometry: &Geometry, primitive: u32, luminous: &Luminous) -> Strength {
        let sides = luminous.emission.sides;
        luminous.strength(|radiance| match geometry.shape(primitive) {
            Some(shape) => {
                let bounds = shape.bounds();
                Strength::of_shape(shape.area(), [bounds.min, bounds.max], shape.facing(), radiance, sides)
            }
            None => Strength::of_triangle(geometry.corners(primitive), false, radiance, sides),
        })
    }

    /// Emission of a primitive that is not an instance.
    #[inline]
    fn luminous(&self, geometry: &Geometry, primitive: u32) -> Luminous<'_> {
        luminous(&self.emission, &self.open, geometry.locate(primitive).0)
    }

    /// Strength of each light within the scene, by number.
    fn strengths(&self, geometry: &Geometry) -> Vec<Strength> {
        let of_primitive =
            |&primitive: &u32| Self::of_primitive(geometry, primitive, &self.luminous(geometry, primitive));
        let of_light = |light: &Arc<dyn Light>| match light.reach() {
            Reach::Finite { power, bounds } => Strength { power, bounds },
            Reach::Infinite { .. } => Strength::NONE,
        };
        let surfaces = self.surfaces.iter().map(of_primitive);
        surfaces.chain(self.copied.strengths(geometry)).chain(self.inside.iter().map(of_light)).collect()
    }

    /// Returns whether no light can be sampled.
    pub fn is_dark(&self) -> bool {
        self.choice.is_none() && self.infinite.is_dark()
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.emission.as_slice())
            + size_of_val(self.shines.as_slice())
            + size_of_val(self.open.as_slice())
            + size_of_val(self.first.as_slice())
            + size_of_val(self.surfaces.as_slice())
            + size_of_val(self.kept.as_slice())
            + size_of_val(self.lamps.as_slice())
            + self.copied.bytes()
            + self.inside.iter().map(|light| light.bytes()).sum::<usize>()
            + self.choice.as_ref().map_or(0, Choice::bytes)
            + self.infinite.bytes()
            + self.few.bytes()
    }

    /// Brightness of each light: the mean channel of a surface's radiance, or of another light's power or flux.
    pub fn radiances(&self) -> impl Iterator<Item = f64> {
        let of_surfaces = self.emission.iter().map(|emission| emission.radiance.at(&TexturePoint::NOWHERE).mean());
        let of_others = self.others().map(|light| match light.reach() {
            Reach::Finite { power, .. } => power,
            Reach::Infinite { flux, .. } => flux,
        });
        of_surfaces.chain(of_others)
    }

    /// Lights that are not surfaces.
    pub fn others(&self) -> impl Iterator<Item = &dyn Light> {
        self.inside.iter().chain(self.infinite.lights()).map(|light| &**light)
    }

    /// Emission of a shape.
    #[inline]
    pub fn emission(&self, shape: u32) -> &Emission {
        &self.emission[shape as usize]
    }

    /// Returns whether a shape emits.
    #[inline]
    pub fn shines(&self, shape: u32) -> bool {
        self.shines[shape as usize]
    }

    /// Sum of radiance from infinite lights along a unit direction.
    #[inline]
    pub fn infinite_radiance(&self, direction: DVec3) -> Rgb {
        self.infinite.radiance(direction, None)
    }

    /// Sum of radiance from infinite lights at these wavelengths.
    #[inline]
    pub fn infinite_radiance_at(&self, direction: DVec3, waves: Option<&Waves>) -> Rgb {
        self.infinite.radiance(direction, waves)
    }

    /// Samples incident light at a receiver: a light by `choice`, a direction by `u`. Returns `None` if the sample
    /// carries no light.
    #[inline]
    pub fn sample(
        &self,
        geometry: &Geometry,
        receiver: &LightSampleContext,
        choice: f64,
        u: [f64; 2],
    ) -> Option<LightSample> {
        let share = self.infinite.share();
        if choice < share {
            return Some(self.infinite.sample(receiver, choice / share, u)?.chosen(share));
        }
        let choice = if share > 0.0 { ((choice - share) / (1.0 - share)).min(1.0 - f64::EPSILON) } else { choice };
        let (chosen, probability) = self.choice.as_ref()?.sample(receiver, choice)?;
        Some(self.sample_within(chosen, geometry, receiver, u)?.chosen((1.0 - share) * probability))
    }

    /// Samples a light within the scene, by its number, as if it were the only one.
    #[inline]
    fn sample_within(
        &self,
        number: usize,
        geometry: &Geometry,
        receiver: &LightSampleContext,
        u: [f64; 2],
    ) -> Option<LightSample> {
        if let Some(&primitive) = self.surfaces.get(number) {
            return surface::sample_primitive(geometry, &self.luminous(geometry, primitive), primitive, receiver, u);
        }
        let number = number - self.surfaces.len();
        if number < self.copied.len() {
            return self.copied.sample(number, geometry, receiver, u);
        }
        self.inside[number - self.copied.len()].sample(receiver, u)
    }

    /// Density with which [`Lights::sample`] samples the unit direction of a ray that leaves a receiver and hits an
    /// emissive primitive; the cosine is that to its normal. It is 0 for emitters that are never sampled: those in
    /// moving, nested or too many instances.
    #[inline]
    pub fn surface_pdf(
        &self,
        geometry: &Geometry,
        receiver: &LightSampleContext,
        ray: &Ray,
        hit: &Hit,
        cosine: f64,
    ) -> f64 {
        let Some(choice) = &self.choice else { return 0.0 };
        let Some(number) = self.number_of(geometry, hit) else { return 0.0 };
        let probability = (1.0 - self.infinite.share()) * choice.probability(number, receiver);
        if probability > 0.0 {
            probability * self.pdf_within(number, geometry, receiver, (ray, hit), cosine)
        } else {
            0.0
        }
    }

    /// Precomputed data of a surface light, if its emission is uniform.
    #[inline]
    fn plain(&self, geometry: &Geometry, number: usize) -> Option<PlainLight> {
        if let Some(kept) = self.kept.get(number) {
            return *kept;
        }
        let &primitive = self.surfaces.get(number)?;
        PlainLight::new(geometry, &self.luminous(geometry, primitive), primitive)
    }

    /// The number of a hit light; `None` if it is in instances and never sampled.
    #[inline]
    fn number_of(&self, geometry: &Geometry, hit: &Hit) -> Option<usize> {
        let (shape, number) = geometry.locate(hit.primitive);
        if geometry.instances_of(shape).is_some() {
            return Some(self.surfaces.len() + self.copied.find(shape, number, hit.inner)?);
        }
        Some((self.first[shape as usize] + number) as usize)
    }

    /// Density of [`Lights::sample_within`].
    #[inline]
    fn pdf_within(
        &self,
        number: usize,
        geometry: &Geometry,
        receiver: &LightSampleContext,
        (ray, hit): (&Ray, &Hit),
        cosine: f64,
    ) -> f64 {
        if number < self.surfaces.len() {
            return surface::primitive_pdf(geometry, receiver, ray, hit, cosine);
        }
        self.copied.pdf(number - self.surfaces.len(), geometry, receiver, (ray, hit), cosine)
    }

    /// Density with which [`Lights::sample`] samples, for a receiver, a unit direction that leaves the scene.
    #[inline]
    pub fn infinite_pdf(&self, receiver: &LightSampleContext, direction: DVec3) -> f64 {
        self.infinite.share() * self.infinite.pdf(receiver, direction)
    }
}

/// Emission of a shape, from lists of emission and open materials.
#[inline]
fn luminous<'a>(emission: &'a [Emission], open: &'a [Option<Arc<dyn Material>>], shape: u32) -> Luminous<'a> {
    let shape = shape as usize;
    Luminous { emission: &emission[shape], open: open.get(shape).and_then(|material| material.as_deref()) }
}
