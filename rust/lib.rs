//! raywright: rays to hits, scenes to pictures, each with an honest error.
//!
//! The house has floors, and each uses only those under it; `ARCHITECTURE.md` draws them.

pub mod accel;
pub mod exchange;
pub mod integrators;
pub mod math;
pub mod optics;
pub mod parallel;
pub mod render;
pub mod sampling;
pub mod scene;
pub mod shapes;
pub mod simd;
pub mod timing;
pub mod work;
pub mod workers;

#[cfg(feature = "python")]
mod python;

#[cfg(test)]
extern crate self as raywright;

#[cfg(test)]
#[path = "../tests/main.rs"]
mod tests;
