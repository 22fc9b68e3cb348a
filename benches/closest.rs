//! Closest-hit queries on one thread, by ray type, mesh, SIMD level and BVH width: an item is one ray. Hits are
//! compared with brute force before timing.

mod meshes;

use divan::Bencher;
use divan::counter::ItemsCount;
use meshes::{Icosphere, Kernel, NoisyTorus, Purpose, Slats, Subject};
use raywright::math::Hit;

fn main() {
    divan::main();
}

#[divan::bench(
    types = [Icosphere, NoisyTorus, Slats],
    args = Kernel::all_and_double(),
    sample_count = 10,
    sample_size = 1
)]
fn primary<S: Subject>(bencher: Bencher, kernel: Kernel) {
    time::<S>(bencher, kernel, Purpose::Primary);
}

#[divan::bench(
    types = [Icosphere, NoisyTorus, Slats],
    args = Kernel::all_and_double(),
    sample_count = 10,
    sample_size = 1
)]
fn shadow<S: Subject>(bencher: Bencher, kernel: Kernel) {
    time::<S>(bencher, kernel, Purpose::Shadow);
}

#[divan::bench(
    types = [Icosphere, NoisyTorus, Slats],
    args = Kernel::all_and_double(),
    sample_count = 10,
    sample_size = 1
)]
fn diffuse<S: Subject>(bencher: Bencher, kernel: Kernel) {
    time::<S>(bencher, kernel, Purpose::Diffuse);
}

fn time<S: Subject>(bencher: Bencher, kernel: Kernel, purpose: Purpose) {
    let (tree, rays) = kernel.prepare(S::MESH, purpose);
    let mut hits = vec![Hit::MISS; rays.len()];
    bencher.counter(ItemsCount::new(rays.len())).bench_local(|| tree.intersect(&rays, &mut hits));
}
