//! Floor 0: random numbers, and what turns them into points, directions and choices.

#[cfg(test)]
pub(crate) mod chi_square;
mod discrete;
mod philox;
mod sampler;
pub mod warp;

pub use discrete::AliasTable;
pub use philox::philox4x32;
pub use sampler::{CAMERA_DIMENSIONS, Sampler, SamplerKind};
