//! BVH construction on all cores, by number of triangles: the binary BVH alone (binned SAH), and the complete structure
//! for traversal, by quality. Each is validated, and its hits compared with brute force, before timing.

mod meshes;

use divan::Bencher;
use divan::counter::ItemsCount;
use meshes::{Mesh, Purpose, noisy_torus, rays, validate};
use raywright::accel::Primitives;
use raywright::accel::bvh::build::{Leaves, binned};
use raywright::accel::bvh::{self, Options, Quality};
use raywright::simd::Level;
use raywright::work::Work;

const SIZES: [usize; 4] = [1_000, 10_000, 100_000, 1_000_000];

fn main() {
    divan::main();
}

#[divan::bench(args = SIZES, sample_count = 3, sample_size = 1)]
fn binary(bencher: Bencher, size: usize) {
    let triangles = noisy_torus(size);
    let region = triangles.region();
    let boxes: Vec<_> = (0..triangles.count() as u32).map(|p| region.aabb(triangles.corners(p))).collect();
    let options = binned::Options { bins: Quality::FastBuild.bins(), leaves: Leaves::for_blocks(8) };
    binned::build(&boxes, &options, Work::UNWATCHED).unwrap().validate(&boxes).expect("a valid tree");
    bencher.counter(ItemsCount::new(boxes.len())).bench_local(|| binned::build(&boxes, &options, Work::UNWATCHED));
}

#[divan::bench(args = SIZES, sample_count = 3, sample_size = 1)]
fn fast_build(bencher: Bencher, size: usize) {
    widest(bencher, size, Quality::FastBuild);
}

#[divan::bench(args = SIZES, sample_count = 3, sample_size = 1)]
fn balanced(bencher: Bencher, size: usize) {
    widest(bencher, size, Quality::Balanced);
}

#[divan::bench(args = SIZES, sample_count = 3, sample_size = 1)]
fn fast_rays(bencher: Bencher, size: usize) {
    widest(bencher, size, Quality::FastRays);
}

fn widest(bencher: Bencher, size: usize, quality: Quality) {
    let level = Level::current().expect("a level of this processor");
    let triangles = noisy_torus(size);
    let build = || bvh::widest(&triangles, &Options { quality, ..Options::DEFAULT }, level);
    let tree = build();
    tree.validate(&triangles).expect("a valid tree");
    validate(&triangles, tree.as_ref(), &rays(Mesh::NoisyTorus, &triangles, tree.as_ref(), Purpose::Primary));
    bencher.counter(ItemsCount::new(triangles.count())).bench_local(build);
}
