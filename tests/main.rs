//! Tests of the public interface, as a user's crate sees it.
//!
//! They are compiled with the crate's unit tests (see `rust/lib.rs`). Separate crates would compile the crate again,
//! and instantiate its generic code again for each.

#[path = "extending/main.rs"]
mod extending;
#[path = "../rust/accel/src/fans.rs"]
mod fans;
#[path = "fuzz/main.rs"]
mod fuzz;
#[path = "hits/main.rs"]
mod hits;
mod house;
mod house_names;
mod routines;

/// Return how many of `all` cases to test: an eighth, or all of them if `RAYWRIGHT_SLOW` is set.
fn cases(all: u32) -> u32 {
    if raywright_base::cases::are_all() { all } else { all.div_ceil(8) }
}
