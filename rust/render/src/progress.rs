//! What watches a render.

use super::HistoryRow;
use std::ops::ControlFlow;

/// Watches a render from the thread that asked for it, and may end it.
pub trait Progress {
    /// A pass is done, and its error is to be trusted or not.
    fn pass(&mut self, row: &HistoryRow, trusted: bool) -> ControlFlow<()>;

    /// Called many times a second while a pass is being worked on.
    fn poll(&mut self) -> ControlFlow<()>;

    /// Called as often: whether to leave the render for now, when what has been begun is done.
    fn pauses(&mut self) -> bool {
        false
    }

    /// Called after a pass: whether to leave the render for now.
    fn rests(&mut self) -> bool {
        self.pauses()
    }
}

/// Lets a render go on to its end.
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
