//! How light scatters along the way that it takes.
//!
//! Surfaces say how they scatter radiance towards a viewer ([`raywright_optics::Bsdf`]). Light that comes from `i` and
//! goes to `o` is flux instead, and must make the same picture: with F(o, i) what a viewer in `o` evaluates for `i`,
//! cosine included, so much of it goes into a solid angle of `o` as
//!
//! F(o, i) |ng·o| / |ng·i|
//!
//! with ng the geometric normal, across which flux is counted (Veach, "Robust Monte Carlo Methods for Light Transport
//! Simulation", 1997, 5.3). All that is not symmetric is in it: shading normals, the index of refraction, and that a
//! shading normal is bent towards who looks. So what is evaluated is always what the viewer would see; what the light
//! itself would see only says where to go.

use crate::parting::Parting;
use raywright_base::math::{DVec3, Frame, Hit, Ray};
use raywright_base::sampling::warp::{cosine_hemisphere, cosine_hemisphere_pdf};
use raywright_optics::spectra::Waves;
use raywright_optics::{Bsdf, BsdfSample, Dispersive, Rgb};
use raywright_scene::materials::BsdfMix;
use raywright_scene::{Encounter, Gaze, LightSampleContext, Scene, SurfaceInteraction};

/// Where light has come to, along a ray of its own; or a path from a camera, which light then meets from elsewhere.
#[derive(Clone)]
pub(crate) struct Arrived<'a> {
    pub scene: &'a Scene,
    pub ray: Ray,
    pub hit: Hit,
    /// The index of refraction on the other side of what the surface encloses.
    pub outside: f64,
    /// The wavelengths of the light; none for red, green and blue.
    pub waves: Option<Waves>,
    /// As the light meets it.
    pub here: SurfaceInteraction,
}

/// The same point as it is met by what comes from elsewhere.
#[expect(
    clippy::large_enum_variant,
    reason = "it lives on the stack, and a box would be allocated at every connection"
)]
pub(crate) enum Met<'a> {
    /// As before, but for the direction.
    Alike(SurfaceInteraction<&'a BsdfMix>),
    /// Otherwise.
    Anew(SurfaceInteraction),
}

impl Met<'_> {
    /// As [`Encounter::evaluate`].
    pub fn evaluate(&self, direction: DVec3) -> (Rgb, f64) {
        match self {
            Self::Alike(here) => here.evaluate(direction),
            Self::Anew(here) => here.evaluate(direction),
        }
    }

    /// As [`Encounter::light_context`].
    pub fn light_context(&self) -> LightSampleContext {
        match self {
            Self::Alike(here) => here.light_context(),
            Self::Anew(here) => here.light_context(),
        }
    }

    /// As [`onward_pdf`], if it is light that meets it.
    pub fn onward_pdf(&self, direction: DVec3) -> f64 {
        match self {
            Self::Alike(here) => onward_pdf(here, direction),
            Self::Anew(here) => onward_pdf(here, direction),
        }
    }
}

/// Where light goes on to.
pub(crate) struct Onward {
    pub direction: DVec3,
    /// What its flux is multiplied by.
    pub weight: Rgb,
    /// The density with which it is drawn, by solid angle; without meaning for a single direction.
    pub pdf: f64,
    /// Whether it goes to the other side.
    pub is_through: bool,
    /// Whether it is a single direction.
    pub is_single: bool,
}

/// How often a direction is drawn about the geometric normal where the shading normal is another: the horizon of the
/// one is not that of the other, and what a viewer sees below the latter is not drawn otherwise.
const ABOUT_GEOMETRIC: f64 = 0.1;

/// How often it is where light meets a surface.
fn about_geometric<B: Bsdf>(here: &SurfaceInteraction<B>) -> f64 {
    if here.is_flat() || here.bsdf().is_delta() { 0.0 } else { ABOUT_GEOMETRIC }
}

/// The density with which a direction is drawn in either way, where that of scattering is given.
fn mixed_pdf<B: Bsdf>(here: &SurfaceInteraction<B>, direction: DVec3, scattering: f64) -> f64 {
    let about = about_geometric(here);
    if about == 0.0 {
        return scattering;
    }
    let (normal, transmits) = (here.normal().dot(direction), here.bsdf().transmits());
    let sides = if transmits { 2.0 } else { 1.0 };
    let about_geometric = if transmits { normal.abs() } else { normal.max(0.0) };
    let about_geometric = cosine_hemisphere_pdf(DVec3::new(0.0, 0.0, about_geometric)) / sides;
    about * about_geometric + (1.0 - about) * scattering
}

/// The density with which light that meets a surface goes on along a direction, by solid angle
/// ([`Arrived::onward`]).
pub(crate) fn onward_pdf<B: Bsdf>(here: &SurfaceInteraction<B>, direction: DVec3) -> f64 {
    mixed_pdf(here, direction, here.evaluate(direction).1)
}

impl<'a> Arrived<'a> {
    pub fn new(scene: &'a Scene, ray: Ray, hit: Hit, outside: f64) -> Self {
        let surface = scene.geometry().surface(&ray, &hit);
        let here = SurfaceInteraction::new(scene, &ray, &hit, surface, 0.0, outside);
        Self { scene, ray, hit, outside, waves: None, here }
    }

    /// The same at some wavelengths, and what parts them there, if anything does: `outside` is the index of refraction
    /// for yellow light, and `around` has how it goes with wavelength, on the front and on the back of the surface.
    pub fn by_waves(
        scene: &'a Scene,
        (ray, hit): (Ray, Hit),
        (outside, around): (f64, [Dispersive; 2]),
        waves: Waves,
    ) -> (Self, Option<Parting>) {
        let surface = scene.geometry().surface(&ray, &hit);
        let is_front = surface.is_front(&ray);
        let around = around[usize::from(!is_front)];
        let (outside, parting) = Parting::at(scene.material_at(&surface), is_front, (outside, around), &waves);
        let here = SurfaceInteraction::new(scene, &ray, &hit, surface, Some(waves), outside);
        (Self { scene, ray, hit, outside, waves: Some(waves), here }, parting)
    }

    /// As what comes from a direction meets it, from a distance, whose rays are so wide here.
    pub fn met_from(&self, direction: DVec3, distance: f64, width: f64) -> Met<'_> {
        if width == 0.0
            && let Some(here) = self.here.met_from(direction)
        {
            return Met::Alike(here);
        }
        let origin = self.here.position() + direction * distance;
        let ray = Ray { origin, direction: -direction, ..self.ray };
        let hit = Hit { t: distance, ..self.hit };
        let surface = *self.here.surface();
        let gaze = Gaze { width, waves: self.waves };
        Met::Anew(SurfaceInteraction::new(self.scene, &ray, &hit, surface, gaze, self.outside))
    }

    /// Back to where it came from.
    pub fn back(&self) -> DVec3 {
        -self.ray.direction
    }

    /// The cosine between a direction and the geometric normal, on either side.
    pub fn cosine(&self, direction: DVec3) -> f64 {
        self.here.surface().normal.dot(direction).abs()
    }

    /// The share of the flux that goes into a solid angle of a direction, as a viewer there sees it.
    pub fn towards(&self, direction: DVec3, distance: f64, width: f64) -> Rgb {
        self.share(direction, || self.met_from(direction, distance, width).evaluate(self.back()).0)
    }

    /// The same by what a viewer evaluates.
    pub fn share(&self, direction: DVec3, evaluated: impl FnOnce() -> Rgb) -> Rgb {
        let (arriving, leaving) = (self.cosine(self.back()), self.cosine(direction));
        if arriving == 0.0 { Rgb::ZERO } else { evaluated() * (leaving / arriving) }
    }

    /// Draws where light goes on to.
    pub fn onward(&self, choice: &mut dyn FnMut() -> f64, [u, v]: [f64; 2]) -> Option<Onward> {
        let here = &self.here;
        let transmits = here.bsdf().transmits();
        let about = about_geometric(here);
        let (direction, is_through, pdf) = if u < about {
            // On either side where light goes through.
            let (u, sign) = match (u / about, transmits) {
                (u, true) if u < 0.5 => (2.0 * u, -1.0),
                (u, true) => (2.0 * u - 1.0, 1.0),
                (u, false) => (u, 1.0),
            };
            let direction = Frame::new(here.normal() * sign).to_world(cosine_hemisphere([u, v]));
            (direction, sign < 0.0, None)
        } else {
            let drawn = here.sample(choice, [(u - about) / (1.0 - about), v])?;
            if drawn.is_delta() {
                return self.single(&drawn, 1.0 - about);
            }
            (drawn.wi, drawn.is_through, Some(drawn.pdf))
        };
        let pdf = mixed_pdf(here, direction, pdf.unwrap_or_else(|| here.evaluate(direction).1));
        // From how far away a viewer looks does not matter to rays without width.
        let weight = self.towards(direction, 1.0, 0.0) / pdf;
        (pdf > 0.0).then_some(Onward { direction, weight, pdf, is_through, is_single: false })
    }

    /// A single direction, of those that are drawn with a probability. What a viewer there would draw is the same one
    /// back, and of it the same share; radiance that is refracted has 1 / η² in it, which is the solid angles' doing.
    fn single(&self, drawn: &BsdfSample, probability: f64) -> Option<Onward> {
        let (here, back) = (&self.here, -self.ray.direction);
        let (normal, shading) = (here.surface().normal, here.shading_normal());
        let shaded = if here.is_flat() {
            1.0
        } else {
            let ratio = |n: DVec3| n.dot(drawn.wi).abs() / n.dot(back).abs();
            ratio(normal) / ratio(shading)
        };
        let weight = drawn.weight * (drawn.eta * drawn.eta * shaded / probability);
        let is_through = drawn.is_through;
        weight.is_radiance().then_some(Onward {
            direction: drawn.wi,
            weight,
            pdf: f64::INFINITY,
            is_through,
            is_single: true,
        })
    }
}
