//! Every fuzz target on some hundred random strings, so that any compiler tests them. `fuzz/` has the same targets for
//! libFuzzer.

mod targets;

use super::cases;
use targets::{hits, leaving, nearest, signs, trees, watertight};

/// Pseudo-random numbers, the same at every run (SplitMix64; Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Bytes, with occasional runs of equal ones, which make points coincide.
    fn bytes(&mut self, most: usize) -> Vec<u8> {
        let length = self.bits() as usize % most;
        let mut bytes = Vec::with_capacity(length);
        while bytes.len() < length {
            let byte = self.bits();
            let run = if byte >> 8 & 15 == 0 { byte >> 12 & 15 } else { 1 };
            bytes.extend((0..run).map(|_| byte as u8));
        }
        bytes
    }
}

/// Feeds `count` strings to a target; `RAYWRIGHT_FUZZ` multiplies their number.
fn feed(target: fn(&[u8]), count: u32) {
    let times: u32 = std::env::var("RAYWRIGHT_FUZZ").map_or(1, |n| n.parse().expect("RAYWRIGHT_FUZZ is a number"));
    let mut random = Random(1);
    for _ in 0..count * times {
        target(&random.bytes(1200));
    }
}

#[test]
fn trees_are_valid() {
    feed(trees::check, cases(1000));
}

#[test]
fn hits_agree() {
    feed(hits::check, cases(200));
}

#[test]
fn surfaces_are_left() {
    feed(leaving::check, 2000);
}

#[test]
fn nearest_points_agree() {
    feed(nearest::check, cases(1000));
}

#[test]
fn signs_are_exact() {
    feed(signs::check, 20_000);
}

#[test]
fn surfaces_are_watertight() {
    feed(watertight::check, cases(300));
}
