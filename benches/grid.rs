//! Grids compared with the BVH, and by their way of avoiding repeated tests: closest hits on one thread. Hits are
//! compared with brute force before timing.

mod meshes;

use divan::Bencher;
use divan::counter::ItemsCount;
use meshes::{Mesh, Purpose, rays, validate};
use raywright::accel::grid::{nested, uniform};
use raywright::accel::walk::Mailbox;
use raywright::accel::{Accelerator, Primitives, bvh, walked};
use raywright::math::Hit;
use raywright::simd::Level;
use std::fmt;

fn main() {
    divan::main();
}

/// An acceleration structure.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Tree,
    Grid(Mailbox),
    Nested(Mailbox),
}

impl Kind {
    const ALL: [Self; 7] = [
        Self::Tree,
        Self::Grid(Mailbox::None),
        Self::Grid(Mailbox::Stamps),
        Self::Grid(Mailbox::Cache),
        Self::Nested(Mailbox::None),
        Self::Nested(Mailbox::Stamps),
        Self::Nested(Mailbox::Cache),
    ];

    fn build(self, primitives: &dyn Primitives) -> Box<dyn Accelerator> {
        let level = Level::current().expect("a level of this processor");
        match self {
            Self::Tree => bvh::widest(primitives, &bvh::Options::DEFAULT, level),
            Self::Grid(mailbox) => {
                walked(primitives, level, mailbox, &|input| uniform::build(input, &uniform::Options::DEFAULT))
            }
            Self::Nested(mailbox) => {
                walked(primitives, level, mailbox, &|input| nested::build(input, &nested::Options::DEFAULT))
            }
        }
    }
}

/// The parameters of a table row.
#[derive(Clone, Copy, Debug)]
struct Case {
    mesh: Mesh,
    kind: Kind,
}

impl Case {
    fn all() -> Vec<Self> {
        Mesh::ALL.into_iter().flat_map(|mesh| Kind::ALL.map(|kind| Self { mesh, kind })).collect()
    }
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}, {:?}", self.mesh, self.kind)
    }
}

#[divan::bench(args = Case::all(), sample_count = 10, sample_size = 1)]
fn primary(bencher: Bencher, case: Case) {
    time(bencher, case, Purpose::Primary);
}

#[divan::bench(args = Case::all(), sample_count = 10, sample_size = 1)]
fn diffuse(bencher: Bencher, case: Case) {
    time(bencher, case, Purpose::Diffuse);
}

#[divan::bench(args = Case::all(), sample_count = 3, sample_size = 1)]
fn build(bencher: Bencher, case: Case) {
    let triangles = case.mesh.triangles();
    bencher.counter(ItemsCount::new(triangles.count())).bench_local(|| case.kind.build(&triangles));
}

fn time(bencher: Bencher, case: Case, purpose: Purpose) {
    let triangles = case.mesh.triangles();
    let structure = case.kind.build(&triangles);
    let rays = rays(case.mesh, &triangles, structure.as_ref(), purpose);
    validate(&triangles, structure.as_ref(), &rays);
    let mut hits = vec![Hit::MISS; rays.len()];
    bencher.counter(ItemsCount::new(rays.len())).bench_local(|| structure.intersect(&rays, &mut hits));
}
