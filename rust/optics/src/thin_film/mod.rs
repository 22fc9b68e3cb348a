//! Interference of thin films, about as thick as a wavelength of light.
//!
//! Reflections from both faces of a film interfere by their path difference: Airy's sum over all reflections within the
//! film. `airy` evaluates it at one wavelength exactly. `layers` evaluates its color, integrated over wavelengths, on
//! bases with a constant index of refraction. It uses tables of `fringes` that all such films share.

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
