//! Directional albedo of microfacets with single scattering. Materials compensate the remaining energy, which meets
//! further facets.
//!
//! The energy loss has no closed form. It is integrated once and tabulated (`quadrature.rs` and `entries.rs`, in tests,
//! write the tables). The table variables make it smooth down to roughness 0: near grazing, a surface of roughness α
//! behaves at cosine μ as every other with the same μ / α. Entries are interpolated by cubics (`cubic.rs`). Lookups are
//! mostly within 0.0005 of the integral, and within 0.003 everywhere. A table's error becomes the surface's energy
//! error. Loss and compensation use the same lookup, so the cosine-weighted average is exactly that of the table.

mod anisotropic;
mod coat;
mod cubic;
#[cfg(test)]
mod entries;
mod interface;
mod isotropic;
mod mirror;
#[cfg(test)]
mod quadrature;
mod rough;
mod schlick;
mod tables;
mod variables;

pub use coat::Coat;
pub use interface::Interface;
pub use mirror::MirrorLoss;
pub use schlick::SchlickShare;
pub use tables::Tables;

use super::{Beckmann, Facets, Ggx};
use anisotropic::Brushed;
use isotropic::Alike;
use rough::Rough;

/// A facet distribution with tables.
pub trait Tabulated: Facets {
    /// Tables of the distribution.
    const TABLES: &'static Tables;
}

impl Tabulated for Ggx {
    const TABLES: &'static Tables = &tables::GGX;
}

impl Tabulated for Beckmann {
    const TABLES: &'static Tables = &tables::BECKMANN;
}
