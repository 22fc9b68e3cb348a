//! Triangles: the exact decision whether a ray meets one, alone and by the block.

mod at_leaf;
mod clip;
mod edge;
mod in_cone;
mod leaves;
mod nearest;
mod pretest;
pub mod routines;
mod sixteen;

pub use at_leaf::Sixteen;
pub use clip::clipped;
pub use edge::{Along, EdgeRay};
pub use in_cone::SolidCone;
pub use leaves::{DoubleLeaves, Leaves, Rows, SingleLeaves};
pub use nearest::{NearestPoint, length, nearest_point, point_of};
pub use pretest::{BlockRay, BlockRays};
pub use sixteen::{ALL, Column, EdgeRays, Met, RAYS, bits};
