//! Floor 4: what surfaces send each other, as numbers instead of pictures.

mod radiosity;

pub use radiosity::{Enclosure, Shots, Sides};
