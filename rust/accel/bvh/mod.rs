//! Bounding volume hierarchies: a binary tree that builders make, and wide trees that rays walk.

pub mod build;
mod node;
mod wide;

pub use node::{BinaryBvh, Node};
pub use wide::{Options, WideBvh};

use super::{Accelerator, Primitives};
use crate::shapes::triangle::{DoubleBlock, TriangleBlock};
use crate::simd::Level;

/// A wide tree over triangles whose coordinates are f32.
pub type SingleBvh<const N: usize> = WideBvh<N, TriangleBlock<N>>;

/// A wide tree over triangles whose coordinates are f64.
pub type DoubleBvh<const N: usize> = WideBvh<N, DoubleBlock<N>>;

/// A wide tree as wide as the level's registers, 8 from AVX2 on and 4 below, that keeps numbers as precisely as they are.
pub fn widest(primitives: &dyn Primitives, options: &Options, level: Level) -> Box<dyn Accelerator> {
    match (level >= Level::Avx2, primitives.is_single()) {
        (true, true) => Box::new(SingleBvh::<8>::new(primitives, options, level)),
        (true, false) => Box::new(DoubleBvh::<8>::new(primitives, options, level)),
        (false, true) => Box::new(SingleBvh::<4>::new(primitives, options, level)),
        (false, false) => Box::new(DoubleBvh::<4>::new(primitives, options, level)),
    }
}
