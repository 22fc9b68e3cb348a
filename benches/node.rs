//! Cost of a node test, by kernel, BVH width and SIMD level: an item is one node and one ray.
//!
//! Kernels trace rays and cannot test a single node. So rays pass between triangles on both sides: they are in each
//! node's bounding box but in none of a leaf, as counted before timing. A ray tests some hundred nodes, so its
//! remaining cost is a few percent. All nodes are in the cache.

mod meshes;

use divan::Bencher;
use divan::counter::ItemsCount;
use meshes::{Kernel, Triangles};
use raywright::accel::bvh::{Options, Quality};
use raywright::accel::{Accelerator, Cost};
use raywright::math::{DVec3, Hit, Ray, Vec3};

fn main() {
    divan::main();
}

/// One ray after the other.
#[divan::bench(args = Kernel::all())]
fn single(bencher: Bencher, kernel: Kernel) {
    // Too few for the batch kernels.
    time(bencher, kernel, 4, false);
}

/// Rays of alternating directions.
#[divan::bench(args = Kernel::all())]
fn wave(bencher: Bencher, kernel: Kernel) {
    time(bencher, kernel, 64, true);
}

/// Coherent rays.
#[divan::bench(args = Kernel::all())]
fn packet(bencher: Bencher, kernel: Kernel) {
    time(bencher, kernel, 64, false);
}

fn time(bencher: Bencher, kernel: Kernel, count: usize, both_ways: bool) {
    let zigzag = zigzag();
    // Minimum leaf size: two positions in one leaf would have the axis in its box.
    let options = Options { quality: Quality::FastBuild, traversal_cost: 1e-3, ..Options::DEFAULT };
    let tree = kernel.build(&zigzag, &options);
    let rays: Vec<Ray> = (0..count).map(|i| ray(i, both_ways && i % 2 == 1)).collect();
    let nodes = nodes(tree.as_ref(), &rays);
    let mut hits = vec![Hit::MISS; rays.len()];
    bencher.counter(ItemsCount::new(nodes)).bench_local(|| tree.intersect(&rays, &mut hits));
}

/// Number of positions along the axis.
const COUNT: usize = 2048;

/// Number of identical triangles per position: more than a leaf of a binary BVH holds, and as many as fit the narrowest
/// leaf.
const COPIES: usize = 4;

/// Distance of positions: so much larger than the triangles that BVHs split along the axis.
const APART: f64 = 64.0;

/// Return triangles along the x axis, alternately on either side of it. So the box of two positions contains a part of
/// the axis, and the box of one does not. They are wider than the gap, or a split by sides would pay.
fn zigzag() -> Triangles {
    let triangle = |i: usize| {
        let (x, side) = (i as f32 * APART as f32, if i.is_multiple_of(2) { 1.0 } else { -1.0 });
        [(1.0, -8.0), (1.0, 8.0), (9.0, 0.0)].map(|(y, z)| Vec3::new(x, side * y, z))
    };
    Triangles((0..COPIES * COUNT).map(|i| triangle(i / COPIES)).collect())
}

/// Return a ray along the axis, in either direction, slightly beside it.
fn ray(i: usize, back: bool) -> Ray {
    let beside = DVec3::new(0.0, (i % 8) as f64 - 3.5, (i / 8) as f64 - 3.5) / 16.0;
    let start = DVec3::new(if back { COUNT as f64 * APART } else { -APART }, 0.0, 0.0);
    Ray::new(start + beside, if back { -DVec3::X } else { DVec3::X })
}

/// Return the number of node tests of all rays. Panic if a ray tests anything else, or not every node.
fn nodes(tree: &dyn Accelerator, rays: &[Ray]) -> usize {
    let mut costs = vec![Cost::default(); rays.len()];
    tree.cost(rays, &mut costs);
    let all = Cost { nodes: tree.info().nodes as u32, primitives: 0 };
    assert!(costs.iter().all(|&cost| cost == all), "{costs:?} of {all:?}");
    costs.iter().map(|c| c.nodes as usize).sum()
}
