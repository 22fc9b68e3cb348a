//! Rows of some rays: borrowed from their array, or copied if they are broadcast.

use super::arrays::TripleRows;
use super::broadcast::Repeats;

/// Rows of some rays, valid while they are used.
pub enum Held<'a> {
    /// Borrowed from the array.
    There(TripleRows<'a>),
    /// float64, copied from a broadcast array.
    Double(Vec<[f64; 3]>),
    /// float32, copied from a broadcast array.
    Single(Vec<[f32; 3]>),
}

impl<'a> Held<'a> {
    /// The rows of a range of rays.
    pub fn of(repeats: Option<&Repeats>, rows: TripleRows<'a>, start: usize, count: usize) -> Self {
        match (repeats, rows) {
            (None, rows) => Self::There(rows.some(start, count)),
            (Some(repeats), TripleRows::Double(rows)) => Self::Double(repeats.rows(rows, start, count)),
            (Some(repeats), TripleRows::Single(rows)) => Self::Single(repeats.rows(rows, start, count)),
        }
    }

    /// Borrows the rows.
    pub fn rows(&self) -> TripleRows<'_> {
        match self {
            Self::There(rows) => *rows,
            Self::Double(rows) => TripleRows::Double(rows),
            Self::Single(rows) => TripleRows::Single(rows),
        }
    }
}
