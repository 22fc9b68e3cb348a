//! Floor 0 of raywright: mathematics, sampling, SIMD and threads, shared by all other crates.

// Used by the tests of all crates.
#[doc(hidden)]
pub mod cases;
pub mod math;
pub mod parallel;
pub mod sampling;
pub mod simd;
pub mod timing;
pub mod work;
pub mod workers;
