//! Films about as thick as a wave of light is long, and the colours that they have.
//!
//! What the two faces of a film reflect comes together again and interferes, by the way that the one part is behind the
//! other: Airy's sum over all reflections within the film. `airy` has it at one wavelength, exactly; `layers` has its
//! colour, integrated over wavelengths, of films on what has one index of refraction for all of them, by tables of
//! `fringes` that serve all such films.

mod airy;
mod complex;
mod fringes;
mod layers;
#[cfg(test)]
mod soap_colours;

pub use airy::{Airy, reflectance};
pub use complex::Complex;
pub use fringes::FARTHEST;
pub use layers::{on_conductor, on_dielectric};
