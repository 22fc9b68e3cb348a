//! Tests of the crate's public API, as a user's own crate would call it.
//!
//! They are compiled with the crate's unit tests (see `rust/lib.rs`): as crates of their own they would compile it once
//! more, and all generic code again for each of them.

#[path = "extending/main.rs"]
mod extending;
#[path = "../rust/accel/src/fans.rs"]
mod fans;
#[path = "fuzz/main.rs"]
mod fuzz;
#[path = "hits/main.rs"]
mod hits;
mod house;
mod routines;

/// Number of cases to try: an eighth, or all if `RAYWRIGHT_SLOW` is set.
fn cases(all: u32) -> u32 {
    if raywright_base::cases::are_all() { all } else { all.div_ceil(8) }
}
