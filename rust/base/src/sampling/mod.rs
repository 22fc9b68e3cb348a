//! Floor 0: random numbers, and their maps to points, directions and discrete choices.

mod bits;
// Used by the tests of all crates; unused code is not linked.
#[doc(hidden)]
pub mod chi_square;
mod discrete;
mod halton;
mod kind;
mod lattice;
mod permutation;
mod philox;
mod sample_columns;
mod sampler;
mod sampler_lanes;
mod scramble;
mod sobol;
mod stratified;
mod stream;
pub mod warp;

#[cfg(test)]
mod tests;

pub use discrete::AliasTable;
pub use kind::{BatchSize, SamplerKind};
pub use philox::philox4x32;
pub use sample_columns::SamplerColumns;
pub use sampler::{CAMERA_DIMENSIONS, Sampler};
pub use sampler_lanes::{Pairs, SamplerLanes};
