//! Floor 1: what can be hit, one shape a module.

mod contact;
mod shape;
pub mod triangle;

pub use contact::{Candidate, Contact};
pub use shape::{Bounds, Drawn, Point, Shape};
