//! Binary trees as arrays without pointers, as graphics processors take them, and what the CPU does for these: it makes
//! rays ready in f64, and decides among the candidates that come back.

mod arrays;
mod nodes;
mod rays;
mod settle;
mod walks;

pub use arrays::{Flat, FlatInstance, FlatTriangle};
pub use nodes::FlatNode;
pub use rays::{FlatRay, flat_ray};
pub use settle::{CANDIDATES, CERTAIN, NO_CANDIDATE, OVERFLOW, Settled, Settler};
pub use walks::{Way, build};
