//! Triangles: the exact decision whether a ray meets one, alone and by the block.

mod block;
mod edge;

pub use block::{BlockRay, DoubleBlock, Lanes, Leaf, TriangleBlock};
pub use edge::{Candidate, Contact, EdgeRay};
