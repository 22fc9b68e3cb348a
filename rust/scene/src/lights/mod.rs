//! All lights of a scene, and the choice among them.

mod aim;
mod bounds;
mod choice;
mod constant;
mod departures;
mod directional;
mod emission_sample;
mod emitters;
mod few;
mod infinite;
mod instanced;
mod lanes;
mod light;
mod light_block;
mod light_lanes;
mod light_sample;
mod light_sample_context;
mod luminous;
mod map;
mod picture;
mod plain;
mod point;
mod projector;
mod pyramid;
pub mod sky;
mod spot;
mod surface;
#[cfg(test)]
mod tests;
mod tree;
mod triangle;
mod waved;

pub use aim::Aim;
pub use bounds::LightBounds;
pub use constant::ConstantEnvironment;
pub use departures::EmissionDensity;
pub use directional::DirectionalLight;
pub use emission_sample::{EmissionPdf, EmissionSample, PointEmission, Source};
pub use emitters::{EmissionNumbers, Emitters, not_drawn};
pub use light::{Light, Place, Reach};
pub use light_block::LightBlock;
pub use light_lanes::{LightContextLanes, LightLanes};
pub use light_sample::LightSample;
pub use light_sample_context::LightSampleContext;
pub use map::EnvironmentMap;
pub use picture::Picture;
pub use point::PointLight;
pub use projector::Projector;
pub use sky::SunSky;
pub use spot::{Profile, SpotLight};
pub use tree::LightTree;
pub use triangle::SeenTriangle;
pub use waved::Waved;

use super::materials::Material;
use super::textures::TexturePoint;
use super::{Emission, Geometry, Sides};
use choice::{Choice, Strength};
use few::Few;
use infinite::InfiniteLights;
use instanced::Copied;
use light_block::TriangleLamp;
use luminous::{Luminous, is_open};
use plain::PlainLight;
use raywright_accel::Primitives;
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use std::sync::Arc;

/// The lights of a scene: emitting surfaces, others that stand within it, and what comes from outside.
///
/// Those within are numbered: first the emitting primitives, shape after shape, then those in instances of prototypes,
/// then what is no surface. One of them is chosen by its power or, where there are many, by what it brings to where it
/// is asked for.
#[derive(Debug)]
pub struct Lights {
    /// How each shape shines, and whether it does.
    emission: Vec<Emission>,
    shines: Vec<bool>,
    /// The materials of those that shine and that rays may go on through; none where there are no such shapes.
    open: Vec<Option<Arc<dyn Material>>>,
    /// For each shape, the number of its first primitive among lights; it means nothing for one that is dark.
    first: Vec<u32>,
    /// The primitives that emit.
    surfaces: Vec<u32>,
    copied: Copied,
    inside: Vec<Arc<dyn Light>>,
    /// `None` if nothing within the scene shines.
    choice: Option<Choice>,
    infinite: InfiniteLights,
    few: Few,
    /// Each primitive that emits, if it is a triangle or a sphere that shines alike everywhere; nothing where there are
    /// more than [`Lights::KEPT`].
    kept: Vec<Option<PlainLight>>,
    /// What shines within the scene, if all of it is triangles that shine alike everywhere.
    lamps: Vec<TriangleLamp>,
}

impl Lights {
    /// Surfaces that shine alike everywhere are kept as they are drawn from where there are so many at most: 2/3 of a
    /// megabyte.
    const KEPT: usize = 1 << 12;

    /// Numbers the lights: the emission of each shape of a geometry, of these materials, and what is no surface.
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
        let lamps = Vec::new();
        let mut all =
            Self { emission, shines, open, first, surfaces, copied, inside, choice, infinite, few, kept, lamps };
        all.lamps = all.triangle_lamps(geometry);
        all
    }

    /// How strong a primitive of the scene is. What no ray can hit must not shine either, and from what has no end no
    /// point can be drawn: its light is found by rays that meet it.
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

    /// How a primitive that is no instance shines.
    #[inline]
    fn luminous(&self, geometry: &Geometry, primitive: u32) -> Luminous<'_> {
        luminous(&self.emission, &self.open, geometry.locate(primitive).0)
    }

    /// How strong each light within the scene is, by its number.
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

    /// Whether nothing shines that could be drawn.
    pub fn is_dark(&self) -> bool {
        self.choice.is_none() && self.infinite.is_dark()
    }

    /// The memory held.
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

    /// How bright each light is: a mean of its channels, of radiance on surfaces and of whatever else of others.
    pub fn radiances(&self) -> impl Iterator<Item = f64> {
        let of_surfaces = self.emission.iter().map(|emission| emission.radiance.at(&TexturePoint::NOWHERE).mean());
        let of_others = self.others().map(|light| match light.reach() {
            Reach::Finite { power, .. } => power,
            Reach::Infinite { flux, .. } => flux,
        });
        of_surfaces.chain(of_others)
    }

    /// Those that are no surfaces.
    pub fn others(&self) -> impl Iterator<Item = &dyn Light> {
        self.inside.iter().chain(self.infinite.lights()).map(|light| &**light)
    }

    /// How a shape shines.
    #[inline]
    pub fn emission(&self, shape: u32) -> &Emission {
        &self.emission[shape as usize]
    }

    /// Whether a shape shines.
    #[inline]
    pub fn shines(&self, shape: u32) -> bool {
        self.shines[shape as usize]
    }

    /// Radiance that comes from outside along a unit direction, of all lights there.
    #[inline]
    pub fn infinite_radiance(&self, direction: DVec3) -> Rgb {
        self.infinite.radiance(direction, None)
    }

    /// The same at some wavelengths.
    #[inline]
    pub fn infinite_radiance_at(&self, direction: DVec3, waves: Option<&Waves>) -> Rgb {
        self.infinite.radiance(direction, waves)
    }

    /// Draws light that reaches a receiver: a light by `choice`, and of that a direction by `u`. `None` if the draw
    /// gives none.
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

    /// Draws light of one that is within the scene, by its number, as if it were the only one.
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

    /// The density with which [`Lights::sample`] draws, for a receiver, the direction of a ray from there, which is
    /// unit and meets an emitting primitive under the cosine of an angle to its normal. 0 for what shines in instances
    /// that move, or in instances of instances, or in too many: it is never drawn, and found by rays that meet it.
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

    /// The surface of a number, if it shines alike everywhere.
    #[inline]
    fn plain(&self, geometry: &Geometry, number: usize) -> Option<PlainLight> {
        if let Some(kept) = self.kept.get(number) {
            return *kept;
        }
        let &primitive = self.surfaces.get(number)?;
        PlainLight::new(geometry, &self.luminous(geometry, primitive), primitive)
    }

    /// The number of the light that was hit; none if it is in instances and never drawn.
    #[inline]
    fn number_of(&self, geometry: &Geometry, hit: &Hit) -> Option<usize> {
        let (shape, number) = geometry.locate(hit.primitive);
        if geometry.instances_of(shape).is_some() {
            return Some(self.surfaces.len() + self.copied.find(shape, number, hit.inner)?);
        }
        Some((self.first[shape as usize] + number) as usize)
    }

    /// The density of [`Lights::sample_within`].
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

    /// The density with which [`Lights::sample`], for a receiver, draws a unit direction that leaves the scene.
    #[inline]
    pub fn infinite_pdf(&self, receiver: &LightSampleContext, direction: DVec3) -> f64 {
        self.infinite.share() * self.infinite.pdf(receiver, direction)
    }
}

/// How a shape shines, of these emissions and open materials.
#[inline]
fn luminous<'a>(emission: &'a [Emission], open: &'a [Option<Arc<dyn Material>>], shape: u32) -> Luminous<'a> {
    let shape = shape as usize;
    Luminous { emission: &emission[shape], open: open.get(shape).and_then(|material| material.as_deref()) }
}
