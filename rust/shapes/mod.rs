//! Floor 1: what can be hit, one shape a module.

pub mod triangle;
