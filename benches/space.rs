//! Closest hits on one thread with spatial subdivisions, compared with the default BVH. Hits are compared with brute
//! force before timing.

mod meshes;

use divan::Bencher;
use divan::counter::ItemsCount;
use meshes::{Mesh, Purpose};
use raywright::accel::kdtree::{Builder, Traversal};
use raywright::accel::walk::{Build, Mailbox};
use raywright::accel::{Accelerator, bsp, bvh, kdtree, octree, walked};
use raywright::math::Hit;
use raywright::simd::Level;
use std::fmt;

fn main() {
    divan::main();
}

/// An acceleration structure.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Bvh,
    KdTree(Builder, Traversal),
    Octree,
    Bsp,
}

/// The parameters of a table row.
#[derive(Clone, Copy, Debug)]
struct Case {
    mesh: Mesh,
    kind: Kind,
}

impl Case {
    fn all() -> Vec<Self> {
        let mut kinds = vec![Kind::Bvh];
        kinds.extend(Builder::ALL.map(|builder| Kind::KdTree(builder, Traversal::Stack)));
        kinds.extend([Kind::KdTree(Builder::Sah, Traversal::Restart), Kind::Octree, Kind::Bsp]);
        Mesh::ALL.into_iter().flat_map(|mesh| kinds.iter().map(move |&kind| Self { mesh, kind })).collect()
    }

    fn build(self, triangles: &meshes::Triangles) -> Box<dyn Accelerator> {
        let level = Level::current().expect("a level of this processor");
        let walked = |build: &Build| walked(triangles, level, Mailbox::Stamps, build);
        match self.kind {
            Kind::Bvh => bvh::widest(triangles, &bvh::Options::DEFAULT, level),
            Kind::KdTree(builder, traversal) => {
                let options = kdtree::Options { builder, traversal, ..kdtree::Options::DEFAULT };
                walked(&|input| kdtree::build(input, &options))
            }
            Kind::Octree => walked(&|input| octree::build(input, &octree::Options::DEFAULT)),
            Kind::Bsp => walked(&|input| bsp::build(input, &bsp::Options::DEFAULT)),
        }
    }
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.kind {
            Kind::Bvh => write!(f, "{}, BVH", self.mesh),
            Kind::KdTree(builder, traversal) => {
                write!(f, "{}, kD-tree, {}, {}", self.mesh, builder.name(), traversal.name())
            }
            Kind::Octree => write!(f, "{}, octree", self.mesh),
            Kind::Bsp => write!(f, "{}, BSP tree", self.mesh),
        }
    }
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
    let triangles = case.mesh.triangles();
    let tree = case.build(&triangles);
    let rays = meshes::rays(case.mesh, &triangles, tree.as_ref(), purpose);
    meshes::validate(&triangles, tree.as_ref(), &rays);
    let mut hits = vec![Hit::MISS; rays.len()];
    bencher.counter(ItemsCount::new(rays.len())).bench_local(|| tree.intersect(&rays, &mut hits));
}
