//! Building trees on all cores, by number of triangles: the binary tree alone (binned SAH), and all of what rays walk. Each
//! is valid, and has given the hits of brute force, before it is timed.

mod meshes;

use divan::Bencher;
use divan::counter::ItemsCount;
use meshes::{Mesh, Purpose, noisy_torus, rays, validate};
use raywright::accel::Primitives;
use raywright::accel::bvh::build::binned;
use raywright::accel::bvh::{Options, SingleBvh};
use raywright::simd::{Dispatch, Level};

const SIZES: [usize; 4] = [1_000, 10_000, 100_000, 1_000_000];

fn main() {
    divan::main();
}

#[divan::bench(args = SIZES, sample_count = 3, sample_size = 1)]
fn binary(bencher: Bencher, size: usize) {
    let triangles = noisy_torus(size);
    let region = triangles.region();
    let boxes: Vec<_> = (0..triangles.count() as u32).map(|p| region.aabb(triangles.corners(p))).collect();
    binned::build(&boxes, Options::DEFAULT.bins).validate(&boxes).expect("a valid tree");
    bencher.counter(ItemsCount::new(boxes.len())).bench_local(|| binned::build(&boxes, Options::DEFAULT.bins));
}

#[divan::bench(args = SIZES, sample_count = 3, sample_size = 1)]
fn four_wide(bencher: Bencher, size: usize) {
    wide::<4>(bencher, size);
}

#[divan::bench(args = SIZES, sample_count = 3, sample_size = 1)]
fn eight_wide(bencher: Bencher, size: usize) {
    wide::<8>(bencher, size);
}

fn wide<const N: usize>(bencher: Bencher, size: usize)
where
    Level: Dispatch<N>,
{
    let level = Level::current().expect("a level of this processor");
    let triangles = noisy_torus(size);
    let build = || SingleBvh::<N>::new(&triangles, &Options::DEFAULT, level);
    let tree = build();
    tree.validate(&triangles).expect("a valid tree");
    validate(&triangles, &tree, &rays(Mesh::NoisyTorus, &triangles, &tree, Purpose::Primary));
    bencher.counter(ItemsCount::new(triangles.count())).bench_local(build);
}
