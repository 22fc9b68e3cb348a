//! Every primitive against every ray: the measure of all other accelerators.

use super::query::{Answers, Query};
use super::{Accelerator, Info, Primitives};
use crate::math::{Ray, Region};
use crate::shapes::triangle::{DoubleBlock, EdgeRay, Leaf, TriangleBlock};
use crate::simd::{Dispatch, Kernel, Level, Simd};
use std::time::Instant;

const LANES: usize = 4;

/// Tests all primitives, four at a time.
#[derive(Debug)]
pub struct BruteForce<L = TriangleBlock<LANES>> {
    blocks: Vec<L>,
    primitives: usize,
    region: Region,
    level: Level,
    info: Info,
}

impl BruteForce {
    /// Collects the primitives, and keeps numbers as precisely as they are.
    pub fn over(primitives: &dyn Primitives, level: Level) -> Box<dyn Accelerator> {
        if primitives.is_single() {
            Box::new(Self::of(primitives, level))
        } else {
            Box::new(BruteForce::<DoubleBlock<LANES>>::of(primitives, level))
        }
    }
}

impl<L: Leaf<LANES>> BruteForce<L> {
    fn of(primitives: &dyn Primitives, level: Level) -> Self {
        let start = Instant::now();
        let region = primitives.region();
        let all: Vec<u32> = (0..primitives.count() as u32).filter(|&p| primitives.is_finite(p)).collect();
        let blocks: Vec<_> =
            all.chunks(LANES).map(|chunk| L::new(&region, chunk.iter().map(|&p| (p, primitives.corners(p))))).collect();
        let info = Info {
            kind: format!("brute force, {}", L::PRECISION),
            primitives: all.len(),
            leaves: blocks.len(),
            bytes: size_of_val(blocks.as_slice()),
            build_seconds: start.elapsed().as_secs_f64(),
            sah_cost: blocks.len() as f64,
            ..Info::default()
        };
        Self { blocks, primitives: all.len(), region, level, info }
    }

    /// Each block with the number of its lanes in use.
    #[inline(always)]
    fn blocks(&self) -> impl Iterator<Item = (&L, u32)> {
        let last = self.primitives.wrapping_sub(1) % LANES + 1;
        let full = self.blocks.len().saturating_sub(1);
        self.blocks.iter().enumerate().map(move |(i, b)| (b, if i == full { last as u32 } else { LANES as u32 }))
    }
}

impl<L: Leaf<LANES>> Answers for BruteForce<L> {
    fn answer<Q: Query>(&self, rays: &[Ray], query: &mut Q) {
        self.level.dispatch(Batch { brute: self, rays, query });
    }

    fn refitted(&self, primitives: &dyn Primitives) -> Result<Self, String> {
        Ok(Self::of(primitives, self.level))
    }

    fn info(&self) -> &Info {
        &self.info
    }
}

struct Batch<'a, L, Q> {
    brute: &'a BruteForce<L>,
    rays: &'a [Ray],
    query: &'a mut Q,
}

impl<L: Leaf<LANES>, Q: Query> Kernel<LANES> for Batch<'_, L, Q> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd<LANES>>(self, simd: S) {
        let Self { brute, rays, query } = self;
        for (i, ray) in rays.iter().enumerate() {
            let Some(edges) = EdgeRay::new(ray, &brute.region) else {
                query.finish(i, None);
                continue;
            };
            let lanes = L::ray(simd, &edges, &brute.region);
            let mut state = query.start(i, &edges);
            for (block, count) in brute.blocks() {
                Q::visit_leaf(&mut state, count);
                if block.meet(simd, &lanes, &edges, count, |p, candidate| query.offer(&mut state, p, candidate)) {
                    break;
                }
            }
            query.finish(i, Some((&edges, state)));
        }
    }
}
