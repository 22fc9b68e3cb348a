//! Canceled builds: every builder stops soon, with an empty result.

use super::triangles::{Random, Triangles, levels};
use raywright::accel::bvh::build::{Builder, morton, ploc, split_rules};
use raywright::accel::bvh::traverse::{Orders, PacketSize, Traversal};
use raywright::accel::bvh::{Options, Quality};
use raywright::accel::walk::{Built, Input, Mailbox};
use raywright::accel::{Accelerator, Primitives, bsp, grid, kdtree, octree, trees, walked};
use raywright::math::DVec3;
use raywright::work::{Watch, Work};
use raywright::workers;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Triangles whose build is canceled after a number of corner lookups.
struct Unwanted<'a> {
    triangles: &'a Triangles,
    asked: AtomicUsize,
    most: usize,
    watch: Watch,
}

impl Primitives for Unwanted<'_> {
    fn count(&self) -> usize {
        self.triangles.count()
    }

    fn corners(&self, primitive: u32) -> [DVec3; 3] {
        if self.asked.fetch_add(1, Relaxed) == self.most {
            self.watch.stop();
        }
        self.triangles.corners(primitive)
    }

    fn is_single(&self) -> bool {
        true
    }

    fn work(&self) -> Work<'_> {
        Work::of(&self.watch)
    }
}

type Over = Box<dyn Fn(&dyn Primitives) -> Box<dyn Accelerator> + Sync + Send>;

/// All structures but brute force, by name.
fn all() -> Vec<(&'static str, Over)> {
    let level = levels().last().unwrap();
    let of = move |builder, quality| -> Over {
        let options = Options { builder, quality, ..Options::DEFAULT };
        Box::new(move |primitives| trees::over(primitives, &options, level))
    };
    let binary =
        move |way| -> Over { Box::new(move |primitives| trees::binary(primitives, &Options::DEFAULT, way, level)) };
    let walk = move |build: fn(&Input) -> Built| -> Over {
        Box::new(move |primitives| walked(primitives, level, Mailbox::Stamps, &build))
    };
    let binned = Builder::Binned { bins: None };
    vec![
        ("binned", of(binned, Quality::FastBuild)),
        ("balanced", of(binned, Quality::Balanced)),
        ("fast rays", of(binned, Quality::FastRays)),
        ("sweep", of(Builder::Sweep, Quality::Balanced)),
        ("morton", of(Builder::Morton(morton::Bits::default()), Quality::Balanced)),
        ("ploc", of(Builder::Ploc { radius: ploc::RADIUS }, Quality::Balanced)),
        ("medians", of(Builder::Halves(split_rules::SplitRule::Median), Quality::Balanced)),
        ("stack", binary(Traversal::Stack(PacketSize::One))),
        ("slabs", binary(Traversal::Slabs)),
        ("threads", binary(Traversal::Threaded(Orders::Eight))),
        ("kD-tree", walk(|input| kdtree::build(input, &kdtree::Options::DEFAULT))),
        ("octree", walk(|input| octree::build(input, &octree::Options::DEFAULT))),
        ("BSP tree", walk(|input| bsp::build(input, &bsp::Options::DEFAULT))),
        ("grid", walk(|input| grid::uniform::build(input, &grid::uniform::Options::DEFAULT))),
        ("nested grids", walk(|input| grid::nested::build(input, &grid::nested::Options::DEFAULT))),
    ]
}

#[test]
fn what_is_stopped_ends_soon_and_holds_nothing() {
    const COUNT: usize = 150_000;
    let mut random = Random(5);
    let triangles = Triangles(
        (0..COUNT)
            .map(|_| {
                let at = random.point(1.0);
                [at, at + random.point(0.02), at + random.point(0.02)].map(|p| p.as_vec3())
            })
            .collect(),
    );
    // One thread, so that the progress at cancellation is deterministic.
    let pool = workers::pool(Some(1)).unwrap();
    for (name, over) in all() {
        // During the bounds pass, the box pass, and later.
        for most in [0, COUNT + COUNT / 3, 2 * COUNT + 500] {
            let unwanted =
                Unwanted { triangles: &triangles, asked: AtomicUsize::new(0), most, watch: Watch::default() };
            let built = pool.install(|| over(&unwanted));
            let asked = unwanted.asked.into_inner();
            if unwanted.watch.is_stopped() {
                // The rest of the current pass: bounds, boxes, a node's partition, or leaves.
                assert!(asked <= most + COUNT, "{name}: {asked} after {most}");
                assert!(most > 2 * COUNT || built.info().leaves == 0, "{name}");
            }
        }
    }
}
