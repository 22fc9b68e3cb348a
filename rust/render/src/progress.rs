//! Interface of progress observers.

use super::HistoryRow;
use std::ops::ControlFlow;

/// Observes a render from the thread that started it, and may end it.
pub trait Progress {
    /// Called after each pass; `trusted` tells whether its error is reliable.
    fn pass(&mut self, row: &HistoryRow, trusted: bool) -> ControlFlow<()>;

    /// Called many times a second during a pass.
    fn poll(&mut self) -> ControlFlow<()>;

    /// Called equally often: returns whether to pause the render once work in progress is done.
    fn pauses(&mut self) -> bool {
        false
    }

    /// Called after a pass: returns whether to pause the render.
    fn rests(&mut self) -> bool {
        self.pauses()
    }
}

/// An observer that does nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quiet;

impl Progress for Quiet {
    fn pass(&mut self, _row: &HistoryRow, _trusted: bool) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn poll(&mut self) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}
