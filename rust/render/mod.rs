//! Floor 5: pictures, how wrong they still are, and what they cost.

mod adaptive;
mod error;
mod film;
pub mod filter;
mod outliers;
mod progress;
mod run;
mod schedule;
mod tile;
mod tiles;

pub use error::ErrorEstimate;
pub use film::Film;
pub use outliers::Carried;
pub use progress::{Progress, Quiet};
pub use run::{HistoryRow, RenderError, Rendering, Settings, render};
pub use schedule::Until;
pub use tile::FilmTile;
