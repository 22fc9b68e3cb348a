//! Triangles: the exact decision whether a ray meets one, alone and by the block.

mod edge;
mod leaves;
mod nearest;
pub mod routines;
mod sixteen;

pub use edge::{Along, EdgeRay};
pub use leaves::{BlockRay, BlockRays, DoubleLeaves, Leaves, SingleLeaves};
pub use nearest::{NearestPoint, length, nearest_point, point_of};
pub use sixteen::{ALL, Column, EdgeRays, Met, RAYS, bits};
