//! Cost of exact intersection per ray on one thread: the same BVHs and kernels with leaves that trust f32, with the
//! exact leaves, and with leaves that store f64. They run in turns, so that other load on the machine affects all
//! alike.
//!
//! The exact leaves' hits equal those of brute force bit for bit before timing. The table lists how often the others
//! err.

mod meshes;
#[path = "leaves/plain.rs"]
mod plain;

use meshes::{Doubles, Mesh, Purpose, Triangles, rays, validate};
use plain::PlainLeaves;
use raywright::accel::bvh::{self, Options};
use raywright::accel::{Accelerator, Primitives};
use raywright::math::{Hit, Ray, coherence};
use raywright::simd::Level;
use std::hint::black_box;
use std::time::Instant;

/// Number of turns.
const TURNS: usize = 41;

/// Rays per timing: as many as in a typical batch per thread, and much less than a time slice.
const CHUNK: usize = 2048;

/// Ray query.
#[derive(Clone, Copy)]
enum Asked {
    Closest,
    Any,
}

/// Cost of one leaf type relative to another's speed.
#[derive(Default)]
struct Prices {
    exact: Vec<f64>,
    double: Vec<f64>,
}

fn main() {
    // Without this flag, as in `cargo test --benches`, everything is checked and nothing timed.
    let is_timed = std::env::args().any(|arg| arg == "--bench");
    let level = Level::current().expect("a level of this processor");
    println!(
        "Million rays a second on one thread at {}; what exact costs plain, and double exact, of its speed.",
        level.name()
    );
    println!();
    println!("| mesh | rays | asked | kernel | plain | exact | double | exact costs | double costs | plain errs on |");
    println!("|---|---|---|---|---|---|---|---|---|---|");
    let mut prices = [Prices::default(), Prices::default()];
    for mesh in Mesh::ALL {
        let triangles = mesh.triangles();
        let trees = trees(&triangles, level);
        for purpose in [Purpose::Primary, Purpose::Shadow, Purpose::Diffuse] {
            let rays = rays(mesh, &triangles, trees[1].as_ref(), purpose);
            let wrong = disagreeing(&triangles, &trees, &rays);
            if !is_timed {
                continue;
            }
            let ray = |i: usize| (rays[i].origin, rays[i].direction);
            let in_packets = coherence::is_coherent(rays.len(), ray, triangles.region().radius);
            for asked in [Asked::Closest, Asked::Any] {
                let seconds = turns(&trees, &rays, asked);
                let speed = |i: usize| rays.len() as f64 / seconds[i] / 1e6;
                let price = |other: usize, of: usize| 1.0 - seconds[of] / seconds[other];
                let (exact, double) = (price(1, 0), price(2, 1));
                println!(
                    "| {mesh} | {} | {} | {} | {:.2} | {:.2} | {:.2} | {:.1} % | {:.1} % | {wrong} of {} |",
                    format!("{purpose:?}").to_lowercase(),
                    if matches!(asked, Asked::Any) { "any" } else { "closest" },
                    if in_packets { "packets" } else { "waves" },
                    speed(0),
                    speed(1),
                    speed(2),
                    100.0 * exact,
                    100.0 * double,
                    rays.len(),
                );
                prices[usize::from(in_packets)].exact.push(exact);
                prices[usize::from(in_packets)].double.push(double);
            }
        }
    }
    for (name, Prices { exact, double }) in ["waves", "packets"].into_iter().zip(&prices) {
        if !exact.is_empty() {
            println!();
            println!("In {name}, exact costs {} of plain, and double {} of exact.", range(exact), range(double));
        }
    }
}

/// Return the BVHs with plain, exact and double leaves.
fn trees(triangles: &Triangles, level: Level) -> [Box<dyn Accelerator>; 3] {
    let plain = match level.lanes() {
        8 => bvh::with_leaves::<8, PlainLeaves<8>>(triangles, &Options::DEFAULT, level),
        _ => bvh::with_leaves::<4, PlainLeaves<4>>(triangles, &Options::DEFAULT, level),
    };
    let exact = bvh::widest(triangles, &Options::DEFAULT, level);
    [plain, exact, bvh::widest(&Doubles(triangles), &Options::DEFAULT, level)]
}

/// Return the number of rays with wrong hits if f32 is trusted. Panic if the exact leaves err, or if the plain ones err
/// more often than a correct f32 test does.
fn disagreeing(triangles: &Triangles, trees: &[Box<dyn Accelerator>; 3], rays: &[Ray]) -> usize {
    validate(triangles, trees[1].as_ref(), rays);
    validate(triangles, trees[2].as_ref(), rays);
    let [plain, exact, double] = trees.each_ref().map(|tree| {
        let mut hits = vec![Hit::MISS; rays.len()];
        tree.intersect(rays, &mut hits);
        hits
    });
    assert_eq!(exact, double);
    let wrong = plain.iter().zip(&exact).filter(|(p, e)| p.primitive != e.primitive).count();
    assert!(100 * wrong <= rays.len(), "plain leaves err on {wrong} of {} rays", rays.len());
    wrong
}

/// Return the seconds that each BVH takes for all rays.
///
/// Each BVH traces all rays before the next one does, with its own nodes in the cache; the order rotates. The time of a
/// chunk is the median over all turns, since other processes disturb only few turns.
fn turns(trees: &[Box<dyn Accelerator>; 3], rays: &[Ray], asked: Asked) -> [f64; 3] {
    let mut hits = [Hit::MISS; CHUNK];
    let mut occluded = [false; CHUNK];
    let mut time = |tree: &dyn Accelerator, rays: &[Ray]| {
        let start = Instant::now();
        match asked {
            Asked::Closest => tree.intersect(black_box(rays), &mut hits[..rays.len()]),
            Asked::Any => tree.occluded(black_box(rays), &mut occluded[..rays.len()]),
        }
        start.elapsed().as_secs_f64()
    };
    let mut seconds: [Vec<Vec<f64>>; 3] = [const { Vec::new() }; 3];
    for turn in 0..TURNS {
        for i in 0..trees.len() {
            let i = (i + turn) % trees.len();
            seconds[i].push(rays.chunks(CHUNK).map(|rays| time(trees[i].as_ref(), rays)).collect());
        }
    }
    let chunks = 0..rays.len().div_ceil(CHUNK);
    seconds.map(|turns| chunks.clone().map(|chunk| middle(turns.iter().map(|turn| turn[chunk]))).sum())
}

/// Return the median.
fn middle(numbers: impl Iterator<Item = f64>) -> f64 {
    let mut numbers: Vec<f64> = numbers.collect();
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}

/// Format the minimum, median and maximum.
fn range(prices: &[f64]) -> String {
    let least = prices.iter().copied().fold(f64::INFINITY, f64::min);
    let most = prices.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    format!(
        "{:.0} to {:.0} % ({:.0} % in the middle)",
        100.0 * least,
        100.0 * most,
        100.0 * middle(prices.iter().copied())
    )
}
