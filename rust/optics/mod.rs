//! Floor 1: how much light there is, and how a surface scatters it.

pub mod albedo;
mod any_bsdf;
mod beckmann;
mod blinn_phong;
mod bsdf;
#[cfg(test)]
mod checks;
#[cfg(test)]
mod chi_square;
mod coated;
mod coated_once;
mod conductor;
pub mod conductors;
mod dielectric;
mod diffuse;
mod faceted;
mod facets;
pub mod fresnel;
pub mod furnace;
mod ggx;
mod lobes;
mod losses;
mod metallic_rough;
mod mirror;
mod null;
mod once;
mod one_of;
mod oren_nayar;
mod phong;
pub mod spectra;
mod spectrum;
mod thin_dielectric;
mod through;
mod transparent;

pub use any_bsdf::AnyBsdf;
pub use beckmann::Beckmann;
pub use blinn_phong::BlinnPhong;
pub use bsdf::{Bsdf, BsdfSample};
pub use coated::Coated;
pub use coated_once::CoatedOnce;
pub use conductor::{Conductor, ConductorLanes};
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use faceted::Faceted;
pub use facets::Facets;
pub use ggx::Ggx;
pub use metallic_rough::MetallicRough;
pub use mirror::Mirror;
pub use null::Null;
pub use once::Once;
pub use oren_nayar::OrenNayar;
pub use phong::Phong;
pub use spectrum::{Rgb, RgbLanes};
pub use thin_dielectric::ThinDielectric;
pub use through::Through;
pub use transparent::Transparent;
