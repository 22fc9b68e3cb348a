//! Cost of a triangle test by the level that decides: f32 in the leaf, for certain rejections; f64, if its error bound
//! suffices; else integers. An item is one triangle.

mod leaves;

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use leaves::Full;
use raywright::math::{DVec3, Ray, Region, exact_edges};
use raywright::shapes::triangle::EdgeRay;
use raywright::simd::Level;

fn main() {
    divan::main();
}

/// Return a triangle and a ray to the point with these weights.
fn aimed(weights: [f64; 3]) -> (Ray, [DVec3; 3]) {
    let corners = [[0.75, -0.3125, 2.1], [-0.46, 0.8, 1.9], [-0.3, -0.7, 2.4]]
        .map(|c: [f32; 3]| DVec3::from_array(c.map(f64::from)));
    let target = corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2];
    let origin = DVec3::new(0.1, 0.2, -1.0);
    (Ray::new(origin, target - origin), corners)
}

/// Full leaves, at the level of the kernels.
#[divan::bench]
fn rejected(bencher: Bencher) {
    let level = Level::current().expect("a level of this processor");
    let lanes = level.lanes();
    if lanes == 8 {
        let full = Full::<8>::new(8, false);
        bencher.counter(ItemsCount::new(full.len() * lanes)).bench_local(|| black_box(&full).left(level));
    } else {
        let full = Full::<4>::new(4, false);
        bencher.counter(ItemsCount::new(full.len() * lanes)).bench_local(|| black_box(&full).left(level));
    }
}

#[divan::bench]
fn certain(bencher: Bencher) {
    let (ray, corners) = aimed([0.25, 0.5, 0.25]);
    let ray = EdgeRay::new(&ray, &Region::around(corners)).expect("a ray that can hit");
    assert!(ray.meet(corners).is_some());
    bencher.counter(ItemsCount::new(1usize)).bench_local(|| ray.meet(black_box(corners)));
}

#[divan::bench]
fn exact(bencher: Bencher) {
    let (ray, corners) = aimed([0.5, 0.5, 0.0]);
    assert!(exact_edges(ray.origin, ray.direction, corners)[2].abs() < 1e-15, "a ray aimed at an edge");
    bencher
        .counter(ItemsCount::new(1usize))
        .bench_local(|| exact_edges(ray.origin, black_box(ray.direction), black_box(corners)));
}
