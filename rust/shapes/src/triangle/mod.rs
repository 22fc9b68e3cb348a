//! Exact ray-triangle intersection, for single triangles and for blocks of them.

mod bracket;
mod clip;
mod depth;
mod edge;
mod f32_rays;
mod in_cone;
mod leaf_rows;
mod leaf_storage;
mod leaves;
mod nearest;
mod pretest;
pub mod routines;
mod sixteen_rays;
mod spread_triangles;

pub use bracket::Bracket;
pub use clip::clipped;
pub use edge::{About, Along, EdgeRay};
pub use f32_rays::PlainRays;
pub use in_cone::SolidCone;
pub use leaf_rows::Rows;
pub use leaf_storage::{DoubleLeaves, SingleLeaves};
pub use leaves::{Leaves, Real};
pub use nearest::{NearestPoint, length, nearest_point, point_of};
pub use pretest::{BlockRay, BlockRays};
pub use sixteen_rays::{ALL, Column, EdgeRays, Met, RAYS, bits};
pub use spread_triangles::Spread;
