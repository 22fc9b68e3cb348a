//! Exact ray-triangle intersection, for single triangles and for blocks of them.

mod bracket;
mod clip;
mod depth;
mod edge;
mod in_cone;
mod leaf_storage;
mod leaves;
mod nearest;
mod plain;
mod pretest;
pub mod routines;
mod rows;
mod sixteen;
mod spread;

pub use bracket::Bracket;
pub use clip::clipped;
pub use edge::{About, Along, EdgeRay};
pub use in_cone::SolidCone;
pub use leaf_storage::{DoubleLeaves, SingleLeaves};
pub use leaves::{Leaves, Real};
pub use nearest::{NearestPoint, length, nearest_point, point_of};
pub use plain::PlainRays;
pub use pretest::{BlockRay, BlockRays};
pub use rows::Rows;
pub use sixteen::{ALL, Column, EdgeRays, Met, RAYS, bits};
pub use spread::Spread;
