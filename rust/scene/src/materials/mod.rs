//! What surfaces are made of: one interface over all materials.

mod blinn_phong;
mod boundary;
mod bsdf_lanes;
mod bsdf_mix;
mod bump;
mod checks;
mod coats;
mod conductor;
mod dielectric;
mod diffuse;
mod mask;
mod metallic_rough;
mod mirror;
mod mix;
mod normal_map;
mod oren_nayar;
mod phong;
mod plastic;
mod principled;
mod roughness;
mod soap_film;
#[cfg(test)]
mod tests;
mod thin_dielectric;
mod thin_film;
mod tinted;
mod two_sided;

pub use blinn_phong::BlinnPhongMaterial;
pub use boundary::BoundaryMaterial;
pub use bsdf_lanes::BsdfLanes;
pub use bsdf_mix::BsdfMix;
pub use bump::BumpMap;
pub use coats::Coats;
pub use conductor::{ConductorMaterial, Index};
pub use dielectric::DielectricMaterial;
pub use diffuse::DiffuseMaterial;
pub use mask::Mask;
pub use metallic_rough::MetallicRoughMaterial;
pub use mirror::MirrorMaterial;
pub use mix::MixMaterial;
pub use normal_map::NormalMap;
pub use oren_nayar::OrenNayarMaterial;
pub use phong::PhongMaterial;
pub use plastic::PlasticMaterial;
pub use principled::{LookTextures, PrincipledMaterial, PrincipledThinMaterial};
pub use roughness::{FacetKind, Roughness};
pub use soap_film::SoapFilmMaterial;
pub use thin_dielectric::ThinDielectricMaterial;
pub use thin_film::{FilmBase, FilmedMetals, ThinFilmMaterial};
pub use tinted::{TintedBase, TintedMaterial};
pub use two_sided::TwoSided;

use super::ShadingPoint;
use super::media::Medium;
use super::textures::{Needs, TexturePoint};
use raywright_base::math::DVec3;
use raywright_optics::spectra::Waves;
use raywright_optics::{AnyBsdf, Dispersive, Rgb};
use std::fmt::Debug;
use std::sync::Arc;

/// What a surface is made of: says how light is scattered at each of its points.
pub trait Material: Debug + Send + Sync {
    /// How it scatters at a point.
    fn bsdf(&self, at: &ShadingPoint) -> BsdfMix;

    /// What it must know of a point.
    fn needs(&self) -> Needs;

    /// How it scatters where nothing else is around, of index of refraction 1, if that is the same at every point and
    /// on both sides, and it has neither a normal nor a tangent of its own.
    fn constant(&self) -> Option<AnyBsdf> {
        None
    }

    /// The same where the sides may differ: on the front and on the back.
    fn constant_sides(&self) -> Option<[AnyBsdf; 2]> {
        self.constant().map(|bsdf| [bsdf; 2])
    }

    /// The kinds of functions, as [`AnyBsdf::kind`] has them, by which it scatters at every point, on the front and on
    /// the back, if they are known beforehand; at few points it may be by others, unless it is [`AnyBsdf::DIFFUSE`].
    fn kinds(&self) -> Option<[usize; 2]> {
        Some(self.constant_sides()?.map(|bsdf| bsdf.kind()))
    }

    /// What is wrong with it, in a few words; `Ok` if nothing is.
    fn validate(&self) -> Result<(), String>;

    /// The share of rays that meet it, 0 to 1: the others go on as if nothing were there.
    fn opacity(&self, _at: &TexturePoint) -> f64 {
        1.0
    }

    /// The mean of its opacity, about; above 0 unless no ray meets it anywhere.
    fn mean_opacity(&self) -> f64 {
        1.0
    }

    /// Whether all rays meet it everywhere.
    fn is_opaque(&self) -> bool {
        true
    }

    /// Whether light that meets it may go on on its other side.
    fn transmits(&self) -> bool {
        false
    }

    /// A shading normal of its own, unit and on the side of the point's, as bump and normal maps have it.
    fn normal(&self, _at: &ShadingPoint) -> Option<DVec3> {
        None
    }

    /// Where the x axis of its shading frame is to point, if that makes a difference: about along a vector of any
    /// length.
    fn tangent(&self, _at: &ShadingPoint) -> Option<DVec3> {
        None
    }

    /// What fills what it encloses; none for what encloses nothing, as a sheet.
    fn interior(&self) -> Option<Interior> {
        None
    }

    /// Whether it scatters otherwise in a medium of another index of refraction, though it encloses nothing.
    fn minds_outside(&self) -> bool {
        false
    }

    /// What fills it that dims and scatters light; none of what is clear.
    fn medium(&self) -> Option<&Arc<dyn Medium>> {
        None
    }

    /// Whether light passes it straight and whole where the same index of refraction is on both sides.
    fn is_clear(&self) -> bool {
        false
    }

    /// The priority of what it encloses where that has the index of refraction of what is around it.
    fn boundary(&self) -> Option<i32> {
        None
    }

    /// The share of light that goes straight on into what it encloses and out of it, as through a pane, where that has
    /// the index of refraction of what is around it. Whoever follows light among media counts that as no scattering, so
    /// that what the surface scatters is the rest, over its share. For light at such a cosine to the normal.
    fn straight(&self, _cosine: f64, _outside: f64) -> f64 {
        0.0
    }

    /// Whether it is no surface, and what is within begins there.
    fn is_passed(&self) -> bool {
        false
    }

    /// The share of an even light from nowhere that it reflects: the ambient coefficient of the classic models of light
    /// (Phong, "Illumination for Computer Generated Pictures", 1975). Where these have no word for it, the share of
    /// light from everywhere that it scatters into other than single directions.
    fn ambient(&self, at: &ShadingPoint) -> Rgb {
        self.bsdf(at).matt_albedo()
    }
}

/// What fills a closed surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interior {
    /// Its index of refraction, that of yellow light where it goes with wavelength.
    pub ior: f64,
    /// How it goes with wavelength.
    pub dispersion: Dispersive,
    /// Where several overlap, that of the greatest priority is there (Schmidt and Budge, "Simple Nested Dielectrics in
    /// Ray Traced Images", 2002).
    pub priority: i32,
}

impl Interior {
    /// What has an index of refraction that is the same at all wavelengths.
    pub const fn new(ior: f64, priority: i32) -> Self {
        Self { ior, dispersion: Dispersive::NONE, priority }
    }

    /// The index of refraction for the hero of a path's wavelengths.
    #[inline]
    pub fn ior_at(&self, waves: Option<&Waves>) -> f64 {
        waves.and_then(|waves| self.dispersion.at(waves.hero())).unwrap_or(self.ior)
    }
}
