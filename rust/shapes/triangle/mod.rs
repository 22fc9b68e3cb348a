//! Triangles: the exact decision whether a ray meets one, alone and by the block.

mod block;
mod edge;

pub use block::{BlockRay, TriangleBlock};
pub use edge::{Candidate, EdgeRay};
