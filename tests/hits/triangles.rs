//! Triangles and rays for the tests of hits, and the comparison of every accelerator at every level.

use raywright::accel::bvh::traverse::{Orders, PacketSize, Traversal};
use raywright::accel::bvh::{self, Options};
use raywright::accel::grid::{self, Resolution};
use raywright::accel::kdtree::{self, Builder};
use raywright::accel::walk::{Built, Input, Mailbox};
use raywright::accel::{Accelerator, BruteForce, Primitives, bsp, octree, walked};
use raywright::math::{DVec3, Hit, Ray, Region, Vec3};
use raywright::shapes::triangle::EdgeRay;
use raywright::simd::Level;

/// Triangles by their corners.
#[derive(Clone, Debug)]
pub struct Triangles(pub Vec<[Vec3; 3]>);

impl Primitives for Triangles {
    fn count(&self) -> usize {
        self.0.len()
    }

    fn corners(&self, primitive: u32) -> [DVec3; 3] {
        self.0[primitive as usize].map(Vec3::as_dvec3)
    }

    fn is_single(&self) -> bool {
        true
    }
}

impl Triangles {
    /// Return the closest hit by testing each triangle, without boxes, lanes or the f32 pretest.
    fn closest(&self, ray: &Ray, region: &Region) -> Hit {
        let Some(edges) = EdgeRay::new(ray, region) else { return Hit::MISS };
        let mut best = Hit::MISS;
        for p in (0..self.0.len() as u32).filter(|&p| self.is_finite(p)) {
            if let Some(c) = edges.meet(self.corners(p))
                && c.t < best.t
            {
                best = Hit { t: c.t, uv: c.uv, primitive: p, inner: 0 };
            }
        }
        Hit { t: best.t * edges.scale, ..best }
    }
}

/// The SIMD levels of this processor.
pub fn levels() -> impl Iterator<Item = Level> {
    Level::ALL.into_iter().filter(|l| l.is_available())
}

/// Both trees and brute force at every level, and every structure, by name. All are validated.
pub fn accelerators(primitives: &dyn Primitives) -> Vec<(String, Box<dyn Accelerator>)> {
    let mut all: Vec<(String, Box<dyn Accelerator>)> = Vec::new();
    for level in levels() {
        for width in [4, 8].into_iter().filter(|&w| w <= level.lanes()) {
            let tree = bvh::wide(width, primitives, &Options::DEFAULT, level);
            tree.validate(primitives).unwrap();
            all.push((format!("{width} wide, {}", level.name()), tree));
        }
        all.push((format!("brute force, {}", level.name()), BruteForce::over(primitives, level)));
    }
    let level = levels().last().unwrap();
    for (name, build) in STRUCTURES {
        let structure = walked(primitives, level, Mailbox::Stamps, &build);
        structure.validate(primitives).unwrap();
        all.push((name.to_string(), structure));
    }
    all
}

type Build = fn(&Input) -> Built;

/// Structures with single-ray or packet traversal.
const STRUCTURES: [(&str, Build); 17] = [
    ("stack", |input| Traversal::Stack(PacketSize::One).build(input, &Options::DEFAULT)),
    ("packets of 4", |input| Traversal::Stack(PacketSize::Four).build(input, &Options::DEFAULT)),
    ("packets of 64", |input| Traversal::Stack(PacketSize::SixtyFour).build(input, &Options::DEFAULT)),
    ("turned boxes", |input| Traversal::Oriented.build(input, &Options::DEFAULT)),
    ("slabs", |input| Traversal::Slabs.build(input, &Options::DEFAULT)),
    ("six threads", |input| Traversal::Threaded(Orders::Six).build(input, &Options::DEFAULT)),
    ("eight threads", |input| Traversal::Threaded(Orders::Eight).build(input, &Options::DEFAULT)),
    ("grid", |input| grid::uniform::build(input, &grid::uniform::Options::DEFAULT)),
    ("fine grid", |input| {
        grid::uniform::build(input, &grid::uniform::Options { resolution: Resolution::Each([13, 24, 17]) })
    }),
    ("nested grid", |input| grid::nested::build(input, &grid::nested::Options::DEFAULT)),
    ("kD-tree", |input| kdtree::build(input, &kdtree::Options::DEFAULT)),
    ("kD-tree, median, restart", |input| kdtree::build(input, &kd(Builder::Median, kdtree::Traversal::Restart))),
    ("kD-tree, middle, restart", |input| kdtree::build(input, &kd(Builder::Middle, kdtree::Traversal::Restart))),
    ("kD-tree, cycle, stack", |input| kdtree::build(input, &kd(Builder::Cycle, kdtree::Traversal::Stack))),
    ("octree", |input| octree::build(input, &octree::Options::DEFAULT)),
    ("octree to the end", |input| {
        octree::build(input, &octree::Options { max_depth: octree::MAX_DEPTH, leaf_size: 1 })
    }),
    ("BSP tree", |input| bsp::build(input, &bsp::Options::DEFAULT)),
];

const fn kd(builder: Builder, traversal: kdtree::Traversal) -> kdtree::Options {
    kdtree::Options { builder, traversal, ..kdtree::Options::DEFAULT }
}

/// Return the closest hits after checking that every accelerator at every level gives the same bits, and `occluded` the
/// same answers. Rays are traced as one batch and in small batches, which other kernels process.
pub fn agreed(triangles: &Triangles, rays: &[Ray]) -> Vec<Hit> {
    let region = triangles.region();
    let wanted: Vec<Hit> = rays.iter().map(|r| triangles.closest(r, &region)).collect();
    for (name, accelerator) in accelerators(triangles) {
        for batch in [rays.len().max(1), 3] {
            let mut hits = vec![Hit::MISS; rays.len()];
            let mut occluded = vec![false; rays.len()];
            for ((rays, hits), occluded) in
                rays.chunks(batch).zip(hits.chunks_mut(batch)).zip(occluded.chunks_mut(batch))
            {
                accelerator.intersect(rays, hits);
                accelerator.occluded(rays, occluded);
            }
            for (i, (found, wanted)) in hits.iter().zip(&wanted).enumerate() {
                let ray = &rays[i];
                assert_eq!(bits(found), bits(wanted), "{name}, ray {i} of {batch}: {ray:?}: {found:?} for {wanted:?}");
                assert_eq!(occluded[i], wanted.is_hit(), "{name}, ray {i} of {batch}: {ray:?}: occluded, {wanted:?}");
            }
        }
    }
    wanted
}

/// Return a hit as bits, which distinguish -0 from 0.
pub fn bits(hit: &Hit) -> (u64, [u64; 2], u32) {
    (hit.t.to_bits(), hit.uv.map(f64::to_bits), hit.primitive)
}

/// Return the number of hits.
pub fn hits(hits: &[Hit]) -> usize {
    hits.iter().filter(|h| h.is_hit()).count()
}

/// Pseudorandom numbers, the same on every run (SplitMix64; Steele, Lea and Flood 2014).
pub struct Random(pub u64);

impl Random {
    /// Return 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Return a number from `a` to `b`.
    pub fn between(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Return an index below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// Return one of some values.
    pub fn of<T: Copy>(&mut self, some: &[T]) -> T {
        some[self.below(some.len())]
    }

    /// Return a point in the cube from `-r` to `r`.
    pub fn point(&mut self, r: f64) -> DVec3 {
        DVec3::new(self.between(-r, r), self.between(-r, r), self.between(-r, r))
    }

    /// Return a point of the integer grid from `-r` to `r`.
    pub fn grid(&mut self, r: i32) -> DVec3 {
        let mut x = || (self.below(2 * r as usize + 1) as i32 - r) as f64;
        DVec3::new(x(), x(), x())
    }

    /// Return triangles of about `size` in the cube from -1 to 1.
    pub fn soup(&mut self, count: usize, size: f64) -> Triangles {
        let triangle = |_| {
            let centre = self.point(1.0);
            [0; 3].map(|_| (centre + self.point(size)).as_vec3())
        };
        Triangles((0..count).map(triangle).collect())
    }

    /// Return a vertex, a point on an edge or an inner point of any of the triangles; vertices are exact.
    pub fn target(&mut self, triangles: &Triangles) -> DVec3 {
        let [a, b, c] = triangles.0[self.below(triangles.0.len())].map(|p| p.as_dvec3());
        match self.below(3) {
            0 => a,
            1 => a + (b - a) * self.between(0.0, 1.0),
            _ => a * 0.25 + b * 0.25 + c * 0.5,
        }
    }

    /// Return rays from the cube of size `reach` to vertices, edges and inner points.
    pub fn aimed(&mut self, triangles: &Triangles, count: usize, reach: f64) -> Vec<Ray> {
        (0..count)
            .map(|_| {
                let (origin, target) = (self.point(reach), self.target(triangles));
                Ray::new(origin, target - origin)
            })
            .collect()
    }
}
