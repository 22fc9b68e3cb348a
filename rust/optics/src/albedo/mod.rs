//! How much light microfacets scatter once: the rest meets further facets, and a rough surface has to make up for it.
//!
//! What is lost has no closed form. It is tabulated by integrating once (`quadrature.rs` and `entries.rs`, in tests,
//! which write the tables) in variables in which it is smooth, down to no roughness at all: near grazing a surface of
//! roughness α behaves at cosine μ as every other with the same μ / α. Cubics go through the entries (`cubic.rs`), so
//! that what is read is mostly within 0.0005 of the integral, and within 0.003 everywhere. A surface scatters as much
//! light too much or too little as its table errs, for what is read is what is given back: its mean over even light is
//! that of the table.

mod alike;
mod brushed;
mod coat;
mod cubic;
#[cfg(test)]
mod entries;
mod interface;
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
use alike::Alike;
use brushed::Brushed;
use rough::Rough;

/// Facets of a distribution that has tables.
pub trait Tabulated: Facets {
    /// What they hold.
    const TABLES: &'static Tables;
}

impl Tabulated for Ggx {
    const TABLES: &'static Tables = &tables::GGX;
}

impl Tabulated for Beckmann {
    const TABLES: &'static Tables = &tables::BECKMANN;
}
