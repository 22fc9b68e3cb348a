//! Floor 0 of raywright: what all other crates use.

// For the tests of all crates.
#[doc(hidden)]
pub mod cases;
pub mod math;
pub mod parallel;
pub mod sampling;
pub mod simd;
pub mod timing;
pub mod work;
pub mod workers;
