//! Radiosity: light exchange between diffuse patches, by shooting unshot radiosity along rays.

mod enclosure;
mod first_light;
mod origins;
mod shots;

pub use enclosure::{Enclosure, Sides};
pub use shots::Shots;
