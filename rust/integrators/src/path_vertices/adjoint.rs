//! Adjoint BSDFs: scattering of flux along light paths.
//!
//! BSDFs scatter radiance toward a viewer ([`raywright_optics::Bsdf`]). Light from `i` scattered to `o` is flux, and
//! must give the same picture. Let F(o, i) be the BSDF value, cosine included, that a viewer in direction `o` gets for
//! light from `i`. Then the share of the flux scattered into a solid angle around `o` is
//!
//! F(o, i) |ng·o| / |ng·i|
//!
//! with ng the geometric normal, across which flux is measured (Veach, "Robust Monte Carlo Methods for Light Transport
//! Simulation", 1997, 5.3). This covers every asymmetry: shading normals, the index of refraction, and shading normals
//! bent toward the viewer. The BSDF is always evaluated as for the viewer. Its evaluation from the light's side only
//! guides sampling.

use crate::terminate_wavelengths::Parting;
use raywright_base::math::{DVec3, Frame, Hit, Ray};
use raywright_base::sampling::warp::{cosine_hemisphere, cosine_hemisphere_pdf};
use raywright_optics::spectra::Waves;
use raywright_optics::{Bsdf, BsdfSample, Dispersive, Rgb};
use raywright_scene::materials::BsdfMix;
use raywright_scene::{Interaction, LightSampleContext, LookupContext, Scene, SurfaceInteraction};

/// A surface vertex of a light path. Also a vertex of a camera path, for light that meets it from elsewhere.
#[derive(Clone)]
pub(crate) struct Arrived<'a> {
    pub scene: &'a Scene,
    pub ray: Ray,
    pub hit: Hit,
    /// Index of refraction outside the object.
    pub outside: f64,
    /// Wavelengths of the light; `None` for RGB.
    pub waves: Option<Waves>,
    /// The interaction as seen along the path's ray.
    pub here: SurfaceInteraction,
}

/// The interaction at the same point along another direction.
#[expect(
    clippy::large_enum_variant,
    reason = "it lives on the stack, and a box would be allocated at every connection"
)]
pub(crate) enum AdjointInteraction<'a> {
    /// The same BSDF with another direction.
    Alike(SurfaceInteraction<&'a BsdfMix>),
    /// A new BSDF.
    Anew(SurfaceInteraction),
}

impl AdjointInteraction<'_> {
    /// Evaluate as [`Interaction::evaluate`] does.
    pub fn evaluate(&self, direction: DVec3) -> (Rgb, f64) {
        match self {
            Self::Alike(here) => here.evaluate(direction),
            Self::Anew(here) => here.evaluate(direction),
        }
    }

    /// Return the same as [`Interaction::light_context`].
    pub fn light_context(&self) -> LightSampleContext {
        match self {
            Self::Alike(here) => here.light_context(),
            Self::Anew(here) => here.light_context(),
        }
    }

    /// Return [`onward_pdf`] for light along this direction.
    pub fn onward_pdf(&self, direction: DVec3) -> f64 {
        match self {
            Self::Alike(here) => onward_pdf(here, direction),
            Self::Anew(here) => onward_pdf(here, direction),
        }
    }
}

/// A sampled direction of a light path.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Onward {
    pub direction: DVec3,
    /// Factor on the flux.
    pub weight: Rgb,
    /// Density per solid angle; undefined for a delta direction.
    pub pdf: f64,
    /// True for transmission.
    pub is_through: bool,
    /// True for a delta direction.
    pub is_single: bool,
}

/// Probability of sampling about the geometric normal if the shading normal differs. Directions below the light's
/// shading horizon but visible from the viewer would never be sampled otherwise.
const ABOUT_GEOMETRIC: f64 = 0.1;

/// Return that probability for a surface.
fn about_geometric<B: Bsdf>(here: &SurfaceInteraction<B>) -> f64 {
    if here.is_flat() || here.bsdf().is_delta() { 0.0 } else { ABOUT_GEOMETRIC }
}

/// Return the density of the sampling mixture, given the BSDF's density.
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

/// Return the density per solid angle with which light continues in a direction from a surface ([`Arrived::onward`]).
pub(crate) fn onward_pdf<B: Bsdf>(here: &SurfaceInteraction<B>, direction: DVec3) -> f64 {
    mixed_pdf(here, direction, here.evaluate(direction).1)
}

impl<'a> Arrived<'a> {
    #[inline(always)]
    pub fn new(scene: &'a Scene, ray: Ray, hit: Hit, outside: f64) -> Self {
        let surface = scene.geometry().surface(&ray, &hit);
        let here = SurfaceInteraction::new(scene, &ray, &hit, surface, 0.0, outside);
        Self { scene, ray, hit, outside, waves: None, here }
    }

    /// Make the vertex at given wavelengths. `outside` is the index of refraction for yellow light. `around` holds the
    /// dispersion in front of the surface and behind it.
    pub fn by_waves(
        scene: &'a Scene,
        (ray, hit): (Ray, Hit),
        (outside, around): (f64, [Dispersive; 2]),
        waves: Waves,
    ) -> Self {
        let surface = scene.geometry().surface(&ray, &hit);
        let is_front = surface.is_front(&ray);
        let around = around[usize::from(!is_front)];
        let (outside, _) = Parting::at(scene.material_at(&surface), is_front, (outside, around), &waves);
        let here = SurfaceInteraction::new(scene, &ray, &hit, surface, Some(waves), outside);
        Self { scene, ray, hit, outside, waves: Some(waves), here }
    }

    /// Return the interaction of a ray from a direction and distance, with a given width at this point.
    pub fn met_from(&self, direction: DVec3, distance: f64, width: f64) -> AdjointInteraction<'_> {
        if width == 0.0
            && let Some(here) = self.here.met_from(direction)
        {
            return AdjointInteraction::Alike(here);
        }
        let origin = self.here.position() + direction * distance;
        let ray = Ray { origin, direction: -direction, ..self.ray };
        let hit = Hit { t: distance, ..self.hit };
        let surface = *self.here.surface();
        let gaze = LookupContext { width, waves: self.waves };
        AdjointInteraction::Anew(SurfaceInteraction::new(self.scene, &ray, &hit, surface, gaze, self.outside))
    }

    /// Return the direction back along the path's ray.
    pub fn back(&self) -> DVec3 {
        -self.ray.direction
    }

    /// Return the absolute cosine between a direction and the geometric normal.
    pub fn cosine(&self, direction: DVec3) -> f64 {
        self.here.surface().normal.dot(direction).abs()
    }

    /// Return the share of the flux per solid angle in a direction, for a viewer there.
    pub fn towards(&self, direction: DVec3, distance: f64, width: f64) -> Rgb {
        self.share(direction, || self.met_from(direction, distance, width).evaluate(self.back()).0)
    }

    /// Return the same, given the viewer's BSDF value.
    pub fn share(&self, direction: DVec3, evaluated: impl FnOnce() -> Rgb) -> Rgb {
        let (arriving, leaving) = (self.cosine(self.back()), self.cosine(direction));
        if arriving == 0.0 { Rgb::ZERO } else { evaluated() * (leaving / arriving) }
    }

    /// Sample the next direction of the light.
    pub fn onward(&self, choice: &mut dyn FnMut() -> f64, [u, v]: [f64; 2]) -> Option<Onward> {
        let here = &self.here;
        let transmits = here.bsdf().transmits();
        let about = about_geometric(here);
        let (direction, is_through, pdf) = if u < about {
            // Transmissive surfaces sample either side.
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
        // The viewer's distance is irrelevant for rays without width.
        let weight = self.towards(direction, 1.0, 0.0) / pdf;
        (pdf > 0.0).then_some(Onward { direction, weight, pdf, is_through, is_single: false })
    }

    /// Return a delta direction from a sample with a given probability. A viewer would sample the reverse direction
    /// with the same share. Refracted radiance has the factor 1 / η² from the change of solid angle, which the flux
    /// does not have.
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
