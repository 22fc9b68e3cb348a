//! Rows of some rays: in their array, or copied from where it repeats.

use super::arrays::Rows;
use super::broadcast::Repeats;

/// Rows of some rays that are held as long as they are used.
pub enum Held<'a> {
    /// In the array itself.
    There(Rows<'a>),
    /// float64, copied from where they repeat.
    Double(Vec<[f64; 3]>),
    /// float32, likewise.
    Single(Vec<[f32; 3]>),
}

impl<'a> Held<'a> {
    /// Those of some rays.
    pub fn of(repeats: Option<&Repeats>, rows: Rows<'a>, start: usize, count: usize) -> Self {
        match (repeats, rows) {
            (None, rows) => Self::There(rows.some(start, count)),
            (Some(repeats), Rows::Double(rows)) => Self::Double(repeats.rows(rows, start, count)),
            (Some(repeats), Rows::Single(rows)) => Self::Single(repeats.rows(rows, start, count)),
        }
    }

    /// The same as rows.
    pub fn rows(&self) -> Rows<'_> {
        match self {
            Self::There(rows) => *rows,
            Self::Double(rows) => Rows::Double(rows),
            Self::Single(rows) => Rows::Single(rows),
        }
    }
}
