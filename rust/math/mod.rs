//! Floor 0: rays, boxes, frames and numbers whose errors are known.

mod aabb;
pub mod coherence;
mod exact;
mod frame;
mod ray;
mod region;
pub mod robust;
mod tiling;

pub use aabb::Aabb;
pub use exact::{exact_edges, exact_turn};
pub use frame::Frame;
pub use glam::{DVec3, Vec3};
pub use ray::{Hit, Ray};
pub use region::Region;
pub use tiling::Tiling;
