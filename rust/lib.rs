//! raywright: rays to hits, scenes to pictures, each with an honest error.
//!
//! Each module is a crate of its own, and uses only those below it; `ARCHITECTURE.md` draws them.

pub use raywright_accel as accel;
pub use raywright_base::{math, parallel, sampling, simd, timing, work, workers};
pub use raywright_exchange as exchange;
pub use raywright_integrators as integrators;
pub use raywright_optics as optics;
pub use raywright_render as render;
pub use raywright_scene as scene;
pub use raywright_shapes as shapes;
