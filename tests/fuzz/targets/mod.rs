//! Raywright's guarantees, as functions of any bytes that panic if a guarantee is broken: one file each.
//!
//! `cargo +nightly fuzz run hits` (or `leaving`, `nearest`, `signs`, `trees`, `watertight`) looks for such bytes with
//! libFuzzer; `cargo test --test fuzz` feeds the same functions some hundred random strings, with any compiler.

pub mod hits;
pub mod leaving;
pub mod nearest;
pub mod signs;
pub mod trees;
pub mod watertight;

mod accelerators;
mod builders;
mod integers;
mod numbers;
mod triangles;
