//! Binary trees as pointerless arrays for GPUs, with the CPU side of the traversal: rays are prepared in f64, and
//! returned candidates are decided exactly.

mod arrays;
mod nodes;
mod rays;
mod refine_candidates;
mod walks;

pub use arrays::{Flat, FlatInstance, FlatTriangle};
pub use nodes::FlatNode;
pub use rays::{FlatRay, flat_ray};
pub use refine_candidates::{CANDIDATES, CERTAIN, NO_CANDIDATE, OVERFLOW, Settled, Settler};
pub use walks::{FlatTraversal, build};
