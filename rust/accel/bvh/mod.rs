//! Bounding volume hierarchies: a binary tree that builders make, and wide trees that rays walk.

pub mod build;
mod node;
mod wide;

pub use node::{BinaryBvh, Node};
pub use wide::{Options, WideBvh};

use super::{Accelerator, Primitives};
use crate::simd::Level;

/// A wide tree as wide as the level's registers: 8 from AVX2 on, 4 below.
pub fn widest(primitives: &impl Primitives, options: &Options, level: Level) -> Box<dyn Accelerator> {
    if level >= Level::Avx2 {
        Box::new(WideBvh::<8>::new(primitives, options, level))
    } else {
        Box::new(WideBvh::<4>::new(primitives, options, level))
    }
}
