//! Floor 0: rays, boxes, frames and numbers whose errors are known.

mod aabb;
mod affine;
mod axes;
pub mod coherence;
mod columns;
mod double;
mod double_double;
mod dyadic;
mod elliptic;
pub mod erf;
mod exact;
mod frame;
pub mod gathering;
mod interval;
mod number;
mod ray;
mod region;
pub mod robust;
mod tiling;
pub(crate) mod turn;

pub use aabb::Aabb;
pub use affine::{Affine, Singular};
pub use axes::Axes;
pub use columns::{HitColumns, Numbers, RayBatch, RayColumns, Vectors, read_column};
pub(crate) use double::Double;
pub(crate) use double_double::DoubleDouble;
pub(crate) use dyadic::Dyadic;
pub(crate) use elliptic::ellipsoid_area;
pub use exact::{exact_edges, exact_turn};
pub use frame::Frame;
pub use glam::{DVec3, Vec3};
pub(crate) use interval::Interval;
pub(crate) use number::{Bounded, Number, Triple};
pub use ray::{Hit, Ray};
pub use region::Region;
pub use tiling::{Run, Tiling, row_length};
