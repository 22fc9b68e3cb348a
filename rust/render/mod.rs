//! Floor 5: pictures, how wrong they still are, and what they cost.

mod error;
mod film;
pub mod filter;
mod progress;
mod run;
mod schedule;
mod tiles;

pub use error::ErrorEstimate;
pub use film::{Film, FilmTile, Moments};
pub use progress::{Progress, Quiet};
pub use run::{HistoryRow, RenderError, Rendering, Settings, render};
pub use schedule::Until;
