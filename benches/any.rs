//! Any hits on one thread, by rays, mesh, width of the tree and level of the processor. All have given the hits of brute
//! force before they are timed.

mod meshes;

use divan::Bencher;
use divan::counter::ItemsCount;
use meshes::{Case, Purpose};

fn main() {
    divan::main();
}

#[divan::bench(args = Case::all(), sample_count = 10, sample_size = 1)]
fn primary(bencher: Bencher, case: Case) {
    time(bencher, case, Purpose::Primary);
}

#[divan::bench(args = Case::all(), sample_count = 10, sample_size = 1)]
fn shadow(bencher: Bencher, case: Case) {
    time(bencher, case, Purpose::Shadow);
}

#[divan::bench(args = Case::all(), sample_count = 10, sample_size = 1)]
fn diffuse(bencher: Bencher, case: Case) {
    time(bencher, case, Purpose::Diffuse);
}

fn time(bencher: Bencher, case: Case, purpose: Purpose) {
    let (tree, rays) = case.prepare(purpose);
    let mut occluded = vec![false; rays.len()];
    bencher.counter(ItemsCount::new(rays.len())).bench_local(|| tree.occluded(&rays, &mut occluded));
}
