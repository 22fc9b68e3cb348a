//! Every primitive against every ray: the measure of all other accelerators.

use super::nearest::{Search, of};
use super::query::{Answers, Query};
use super::{Accelerator, Info, Nearest, Primitives};
use crate::math::{DVec3, Ray, Region};
use crate::shapes::triangle::{DoubleLeaves, EdgeRay, Leaves, SingleLeaves};
use crate::simd::{Dispatch, Kernel, Level, Simd};
use std::time::Instant;

const LANES: usize = 4;

/// Tests all primitives, four at a time.
#[derive(Debug)]
pub struct BruteForce<L = SingleLeaves<LANES>> {
    leaves: L,
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
            Box::new(BruteForce::<DoubleLeaves<LANES>>::of(primitives, level))
        }
    }
}

impl<L: Leaves<LANES>> BruteForce<L> {
    fn of(primitives: &dyn Primitives, level: Level) -> Self {
        let start = Instant::now();
        let region = primitives.region();
        let all: Vec<u32> = (0..primitives.count() as u32).filter(|&p| primitives.is_finite(p)).collect();
        let counts: Vec<u32> = all.chunks(LANES).map(|chunk| chunk.len() as u32).collect();
        let leaves = L::new(&region, &all, &counts, |p| primitives.corners(p));
        let count = all.len().div_ceil(LANES);
        let info = Info {
            kind: format!("brute force, {}", L::PRECISION),
            primitives: all.len(),
            leaves: count,
            bytes: leaves.bytes(),
            build_seconds: start.elapsed().as_secs_f64(),
            sah_cost: count as f64,
            ..Info::default()
        };
        Self { leaves, primitives: all.len(), region, level, info }
    }

    /// Of each leaf, its first triangle and its count.
    #[inline(always)]
    fn places(&self) -> impl Iterator<Item = (usize, u32)> {
        (0..self.primitives).step_by(LANES).map(|first| (first, (self.primitives - first).min(LANES) as u32))
    }
}

impl<L: Leaves<LANES>> Answers for BruteForce<L> {
    fn answer<Q: Query>(&self, rays: &[Ray], query: &mut Q) {
        self.level.dispatch(Batch { brute: self, rays, query });
    }

    fn nearest(&self, points: &[DVec3], max_distances: &[f64], nearest: &mut [Nearest]) {
        self.level.dispatch(Points { brute: self, points, max_distances, nearest });
    }

    fn refitted(&self, primitives: &dyn Primitives) -> Result<Self, String> {
        if L::PRECISION == "single" && !primitives.is_single() {
            return Err("corners that are f64 do not fit leaves of f32".into());
        }
        Ok(Self::of(primitives, self.level))
    }

    fn validate(&self, primitives: &dyn Primitives) -> Result<(), String> {
        let kept: Vec<u32> = self.places().flat_map(|(first, count)| self.leaves.primitives(first, count)).collect();
        let wanted: Vec<u32> = (0..primitives.count() as u32).filter(|&p| primitives.is_finite(p)).collect();
        if kept != wanted {
            return Err(format!("{} primitives are kept of {} that can be hit", kept.len(), wanted.len()));
        }
        for (first, count) in self.places() {
            for (lane, p) in self.leaves.primitives(first, count).enumerate() {
                if self.leaves.corners(first, count, lane) != primitives.corners(p) {
                    return Err(format!("primitive {p} has other corners than it was given"));
                }
            }
        }
        Ok(())
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

impl<L: Leaves<LANES>, Q: Query> Kernel<LANES> for Batch<'_, L, Q> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd<LANES>>(self, simd: S) {
        let Self { brute, rays, query } = self;
        for (i, ray) in rays.iter().enumerate() {
            let Some(edges) = EdgeRay::new(ray, &brute.region) else {
                query.finish(i, None);
                continue;
            };
            let lanes = L::ray(&edges, &brute.region);
            let mut state = query.start(i, edges.t_max);
            for (first, count) in brute.places() {
                Q::visit_leaf(&mut state, count);
                let offer = |p, candidate| query.offer(&mut state, p, candidate);
                if brute.leaves.meet(simd, first, count, &lanes, &edges, offer) {
                    break;
                }
            }
            query.finish(i, Some((edges.along(), state)));
        }
    }
}

struct Points<'a, L> {
    brute: &'a BruteForce<L>,
    points: &'a [DVec3],
    max_distances: &'a [f64],
    nearest: &'a mut [Nearest],
}

impl<L: Leaves<LANES>> Kernel<LANES> for Points<'_, L> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd<LANES>>(self, _: S) {
        let Self { brute, points, max_distances, nearest } = self;
        for (i, (&point, nearest)) in points.iter().zip(nearest).enumerate() {
            let Some(mut search) = Search::new(point, of(max_distances, i), &brute.region) else {
                *nearest = Nearest::MISS;
                continue;
            };
            for (first, count) in brute.places() {
                for lane in 0..count as usize {
                    search.offer(brute.leaves.primitive(first, count, lane), brute.leaves.corners(first, count, lane));
                }
            }
            *nearest = search.finish();
        }
    }
}
