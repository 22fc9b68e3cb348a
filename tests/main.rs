//! What is asked of the crate from outside: by its public face alone, as a user's own crate would.
//!
//! They are compiled with the crate's unit tests (see `rust/lib.rs`): as crates of their own they would have it
//! compiled once more, and all that is generic again for each of them.

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

/// How many of so many cases to try: an eighth, or all of them where `RAYWRIGHT_SLOW` is set.
fn cases(all: u32) -> u32 {
    if raywright_base::cases::are_all() { all } else { all.div_ceil(8) }
}
