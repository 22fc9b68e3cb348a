//! Materials: one interface, and one file each.

mod blinn_phong;
mod boundary;
mod bsdf_lanes;
mod bsdf_mix;
mod bump;
mod checks;
mod coat_transmittance;
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
pub use coat_transmittance::Coats;
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

/// The material of a surface; evaluates to a BSDF at each point.
pub trait Material: Debug + Send + Sync {
    /// The BSDF at a point.
    fn bsdf(&self, at: &ShadingPoint) -> BsdfMix;

    /// The lookup data that evaluation needs.
    fn needs(&self) -> Needs;

    /// The BSDF in vacuum, if it is the same at every point and on both sides, and the material changes neither normal
    /// nor tangent.
    fn constant(&self) -> Option<AnyBsdf> {
        None
    }

    /// The constant BSDFs of front and back, which may differ.
    fn constant_sides(&self) -> Option<[AnyBsdf; 2]> {
        self.constant().map(|bsdf| [bsdf; 2])
    }

    /// The BSDF kinds ([`AnyBsdf::kind`]) of front and back, if they are known in advance. A few points may differ,
    /// unless the kind is [`AnyBsdf::DIFFUSE`].
    fn kinds(&self) -> Option<[usize; 2]> {
        Some(self.constant_sides()?.map(|bsdf| bsdf.kind()))
    }

    /// Returns a short reason if the material is invalid.
    fn validate(&self) -> Result<(), String>;

    /// Probability that a ray hits the surface, 0 to 1; other rays pass through.
    fn opacity(&self, _at: &TexturePoint) -> f64 {
        1.0
    }

    /// Approximate mean opacity; above 0 unless all rays pass everywhere.
    fn mean_opacity(&self) -> f64 {
        1.0
    }

    /// Returns whether the opacity is 1 everywhere.
    fn is_opaque(&self) -> bool {
        true
    }

    /// Returns whether light may be transmitted.
    fn transmits(&self) -> bool {
        false
    }

    /// A perturbed shading normal (bump or normal map): a unit vector on the side of the point's normal.
    fn normal(&self, _at: &ShadingPoint) -> Option<DVec3> {
        None
    }

    /// Approximate x axis of the shading frame, of any length, if the BSDF depends on it.
    fn tangent(&self, _at: &ShadingPoint) -> Option<DVec3> {
        None
    }

    /// Interior of a closed surface; `None` for a sheet.
    fn interior(&self) -> Option<Interior> {
        None
    }

    /// Returns whether a sheet's BSDF depends on the surrounding index of refraction.
    fn minds_outside(&self) -> bool {
        false
    }

    /// Participating medium inside; `None` if it is clear.
    fn medium(&self) -> Option<&Arc<dyn Medium>> {
        None
    }

    /// Returns whether light passes unchanged if the index of refraction is the same on both sides.
    fn is_clear(&self) -> bool {
        false
    }

    /// Priority of the interior, for a surface whose interior has the index of refraction of its surroundings.
    fn boundary(&self) -> Option<i32> {
        None
    }

    /// Fraction of light that passes straight through the surface, as through a pane, when both sides have the same
    /// index of refraction. Integrators with media do not count that as scattering; the surface scatters the rest,
    /// divided by its share. `cosine` is that to the normal.
    fn straight(&self, _cosine: f64, _outside: f64) -> f64 {
        0.0
    }

    /// Returns whether the surface only bounds a medium.
    fn is_passed(&self) -> bool {
        false
    }

    /// Reflectance of ambient light: the ambient coefficient of classic shading models (Phong, "Illumination for
    /// Computer Generated Pictures", 1975). Other materials use the albedo of their non-delta components.
    fn ambient(&self, at: &ShadingPoint) -> Rgb {
        self.bsdf(at).matt_albedo()
    }
}

/// The interior of a closed surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interior {
    /// Index of refraction; for yellow light if it depends on the wavelength.
    pub ior: f64,
    /// Dispersion.
    pub dispersion: Dispersive,
    /// If several interiors overlap, the one with the greatest priority applies (Schmidt and Budge, "Simple Nested
    /// Dielectrics in Ray Traced Images", 2002).
    pub priority: i32,
}

impl Interior {
    /// An interior without dispersion.
    pub const fn new(ior: f64, priority: i32) -> Self {
        Self { ior, dispersion: Dispersive::NONE, priority }
    }

    /// Index of refraction at a path's hero wavelength.
    #[inline]
    pub fn ior_at(&self, waves: Option<&Waves>) -> f64 {
        waves.and_then(|waves| self.dispersion.at(waves.hero())).unwrap_or(self.ior)
    }
}
