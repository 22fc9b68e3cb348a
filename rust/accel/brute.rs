//! Every primitive against every ray: the measure of all other accelerators.

use super::{Accelerator, Info, Primitives, extent};
use crate::math::{Aabb, Hit, Ray};
use crate::shapes::triangle::{BlockRay, EdgeRay, TriangleBlock};
use crate::simd::{Dispatch, Kernel, Level, Simd};
use std::time::Instant;

const LANES: usize = 4;

/// Tests all primitives, four at a time.
#[derive(Debug)]
pub struct BruteForce {
    blocks: Vec<TriangleBlock<LANES>>,
    primitives: usize,
    extent: f64,
    level: Level,
    info: Info,
}

impl BruteForce {
    /// Collects the primitives.
    pub fn new(primitives: &impl Primitives, level: Level) -> Self {
        let start = Instant::now();
        let all: Vec<u32> = (0..primitives.count() as u32).filter(|&p| !primitives.aabb(p).is_empty()).collect();
        let bounds = all.iter().fold(Aabb::EMPTY, |b, &p| b.union(primitives.aabb(p)));
        let blocks: Vec<_> = all
            .chunks(LANES)
            .map(|chunk| TriangleBlock::new(chunk.iter().map(|&p| (p, primitives.corners(p)))))
            .collect();
        let info = Info {
            kind: "brute force".into(),
            primitives: all.len(),
            leaves: blocks.len(),
            bytes: size_of_val(blocks.as_slice()),
            build_seconds: start.elapsed().as_secs_f64(),
            sah_cost: blocks.len() as f64,
            ..Info::default()
        };
        Self { blocks, primitives: all.len(), extent: extent(&bounds), level, info }
    }

    /// Each block with the number of its lanes in use.
    #[inline(always)]
    fn blocks(&self) -> impl Iterator<Item = (&TriangleBlock<LANES>, u32)> {
        let last = self.primitives.wrapping_sub(1) % LANES + 1;
        let full = self.blocks.len().saturating_sub(1);
        self.blocks.iter().enumerate().map(move |(i, b)| (b, if i == full { last as u32 } else { LANES as u32 }))
    }
}

impl Accelerator for BruteForce {
    fn intersect(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.level.dispatch(Closest { brute: self, rays, hits });
    }

    fn occluded(&self, rays: &[Ray], occluded: &mut [bool]) {
        self.level.dispatch(Any { brute: self, rays, occluded });
    }

    fn info(&self) -> &Info {
        &self.info
    }
}

struct Closest<'a> {
    brute: &'a BruteForce,
    rays: &'a [Ray],
    hits: &'a mut [Hit],
}

impl Kernel<LANES> for Closest<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd<LANES>>(self, simd: S) {
        for (ray, hit) in self.rays.iter().zip(self.hits) {
            *hit = Hit::MISS;
            if let Some(ray) = EdgeRay::new(ray, self.brute.extent) {
                let lanes = BlockRay::new(simd, &ray);
                for (block, count) in self.brute.blocks() {
                    block.closest(simd, &lanes, &ray, count, hit);
                }
                hit.t *= ray.scale;
            }
        }
    }
}

struct Any<'a> {
    brute: &'a BruteForce,
    rays: &'a [Ray],
    occluded: &'a mut [bool],
}

impl Kernel<LANES> for Any<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd<LANES>>(self, simd: S) {
        for (ray, occluded) in self.rays.iter().zip(self.occluded) {
            *occluded = EdgeRay::new(ray, self.brute.extent).is_some_and(|ray| {
                let lanes = BlockRay::new(simd, &ray);
                self.brute.blocks().any(|(block, count)| block.any(simd, &lanes, &ray, count))
            });
        }
    }
}
