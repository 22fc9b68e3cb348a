//! Floor 1: how much light there is, and how a surface scatters it.

pub mod albedo;
mod blinn_phong;
mod bsdf;
#[cfg(test)]
mod checks;
#[cfg(test)]
mod chi_square;
mod coated;
mod conductor;
pub mod conductors;
mod dielectric;
mod diffuse;
pub mod fresnel;
mod lobes;
mod metallic_rough;
mod microfacet;
mod mirror;
mod null;
mod oren_nayar;
mod phong;
pub mod spectra;
mod spectrum;
mod thin_dielectric;
mod transparent;

pub use blinn_phong::BlinnPhong;
pub use bsdf::{Bsdf, BsdfSample, Scatter};
pub use coated::Coated;
pub use conductor::Conductor;
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use metallic_rough::MetallicRough;
pub use microfacet::Ggx;
pub use mirror::Mirror;
pub use null::Null;
pub use oren_nayar::OrenNayar;
pub use phong::Phong;
pub use spectrum::{Rgb, is_radiance, luminance};
pub use thin_dielectric::ThinDielectric;
pub use transparent::Transparent;
