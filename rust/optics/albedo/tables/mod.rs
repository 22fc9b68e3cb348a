//! Tables written by `quadrature.rs`; `cargo test write_tables -- --ignored` writes them anew.

// Among so many numbers some look like constants.
#![allow(clippy::approx_constant)]

pub mod coat;
pub mod interface_dense;
pub mod interface_thin;
pub mod mirror;
pub mod schlick;
