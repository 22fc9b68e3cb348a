//! Spectra, and their conversion to red, green and blue.
//!
//! Wavelengths are in nm. The visible range is from [`FIRST`] to [`LAST`], where the eye's response is tabulated.

mod any_spectrum;
mod black_body;
mod daylight;
mod linear;
mod observer;
mod observer_table;
mod primaries;
mod response;
mod sigmoid;
mod table;
mod waves;

pub use any_spectrum::Spectrum;
pub use black_body::{COLDEST, black_body, black_body_colour};
pub use daylight::{daylight, white};
pub use linear::at;
pub use observer::matching;
pub use primaries::{xyz_of_primaries, xyz_to_rgb};
pub use response::{Illuminant, Response};
pub use sigmoid::{Role, Smooth};
pub use table::{Table, Told};
pub use waves::Waves;

/// Shortest visible wavelength, nm.
pub const FIRST: f64 = 360.0;

/// Longest visible wavelength, nm.
pub const LAST: f64 = 830.0;
