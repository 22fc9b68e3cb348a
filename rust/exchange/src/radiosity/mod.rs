//! Radiosity: the light that diffuse patches send each other, by shooting what is unshot along rays.

mod enclosure;
mod first_light;
mod origins;
mod shots;

pub use enclosure::{Enclosure, Sides};
pub use shots::Shots;
