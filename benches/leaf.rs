//! Cost of testing a leaf of one to eight triangles against a ray, by leaf width and SIMD level: an item is one leaf
//! and one ray. Leaves are in the cache, and tests are independent of each other.

mod leaves;

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use leaves::Full;
use raywright::simd::{Dispatch, Level};
use std::fmt;

fn main() {
    divan::main();
}

/// The f32 test alone, which rejects all triangles: the usual case.
#[divan::bench(args = Case::all())]
fn missed_in_f32(bencher: Bencher, case: Case) {
    case.time(bencher, false, Test::Left);
}

/// The f32 test alone, which leaves one triangle undecided.
#[divan::bench(args = Case::all())]
fn met_in_f32(bencher: Bencher, case: Case) {
    case.time(bencher, true, Test::Left);
}

/// The f32 test, followed by f64 for undecided triangles.
#[divan::bench(args = Case::all())]
fn met(bencher: Bencher, case: Case) {
    case.time(bencher, true, Test::Met);
}

#[derive(Clone, Copy, Debug)]
enum Test {
    Left,
    Met,
}

#[derive(Clone, Copy, Debug)]
struct Case {
    width: usize,
    level: Level,
    count: u32,
}

impl Case {
    /// Return every leaf size at every SIMD level, each with its native width.
    fn all() -> Vec<Self> {
        let available = Level::ALL.into_iter().filter(|level| level.is_available());
        let sizes =
            |level: Level| (1..=level.lanes() as u32).map(move |count| Self { width: level.lanes(), level, count });
        available.flat_map(sizes).collect()
    }

    fn time(self, bencher: Bencher, meets: bool, test: Test) {
        match self.width {
            4 => self.time_wide::<4>(bencher, meets, test),
            _ => self.time_wide::<8>(bencher, meets, test),
        }
    }

    fn time_wide<const N: usize>(self, bencher: Bencher, meets: bool, test: Test)
    where
        Level: Dispatch<N>,
    {
        let full = Full::<N>::new(self.count, meets);
        let bencher = bencher.counter(ItemsCount::new(full.len()));
        match test {
            Test::Left => bencher.bench_local(|| black_box(&full).left(self.level)),
            Test::Met => bencher.bench_local(|| black_box(&full).met(self.level)),
        }
    }
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{} wide, {}, {} of {}", self.width, self.level.name(), self.count, self.width)
    }
}
