//! Floor 5: pictures, how wrong they still are, and what they cost.

mod adaptive;
mod bias;
mod bytes;
mod camera_samples;
mod cover;
pub mod denoise;
mod denominators;
mod epoch;
mod error;
mod film;
pub mod filter;
mod jumps;
mod outliers;
mod part;
#[cfg(test)]
mod patches;
mod patchwork;
mod pilot;
mod pooled;
mod progress;
mod quarters;
mod rendering;
mod run;
mod schedule;
mod settings;
mod sightings;
mod splats;
mod student;
mod tile;
mod tiles;

pub use bias::bias;
pub use bytes::Malformed;
pub use cover::{Cover, cover};
pub use error::ErrorEstimate;
pub use film::Film;
pub use outliers::Carried;
pub use part::Request;
pub use pilot::{PILOT, pilot};
pub use pooled::Uncertainty;
pub use progress::{Progress, Quiet};
pub use rendering::{HistoryRow, Rendering, roots};
pub use run::{RenderError, go_on, render};
pub use schedule::Until;
pub use settings::Settings;
pub use student::quantile;
pub use tile::FilmTile;
