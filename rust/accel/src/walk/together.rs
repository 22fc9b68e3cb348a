//! Rays that are walked together, leaf by leaf. Each keeps its own answer and its own limit; in a leaf each is tested
//! by itself.

use super::contents::{Contents, LeafRay};
use crate::SlabRay;
use crate::query::Query;
use raywright_base::math::{Ray, Region};
use raywright_base::simd::Simd;
use raywright_shapes::triangle::{BlockRay, EdgeRay, Leaves};

/// No more rays are walked together.
pub const MOST_TOGETHER: usize = 64;

/// Takes rays through a structure, some at a time.
pub trait Together {
    /// How many rays there may be, up to [`MOST_TOGETHER`].
    fn width(&self) -> usize;

    /// Begins with some rays, at least one.
    fn start(&mut self, rays: &[SlabRay]);

    /// The next leaf with anything in it that some of the rays may meet, each at a `t` of no more than its limit, in
    /// box units; and which rays these are, bit by bit. Rays that are answered, and those that are missing, have a
    /// limit of −∞, and are not told. No leaf is given twice.
    fn next(&mut self, limits: &[f32; MOST_TOGETHER]) -> Option<(u32, u64)>;

    /// Nodes visited since the start for one of the rays; 0 if none are counted. A test of all rays at once counts
    /// once.
    fn nodes(&self, ray: usize) -> u32;
}

/// A ray of those at hand.
struct Asked<T> {
    /// Its number in the batch.
    number: usize,
    edges: EdgeRay,
    lanes: BlockRay,
    time: f64,
    state: T,
}

/// What a batch is asked about.
pub struct TogetherBatch<'a, const N: usize, L> {
    pub contents: &'a Contents<N, L>,
    /// What every ray is tested against.
    pub unbounded: &'a [u32],
    pub region: &'a Region,
    pub rays: &'a [Ray],
}

impl<const N: usize, L: Leaves<N>> TogetherBatch<'_, N, L> {
    /// Answers all rays.
    ///
    /// Where a primitive stands in several leaves, a ray may be offered it more than once, which changes no answer:
    /// marks would have to be kept for every ray at hand.
    #[inline(always)]
    pub fn answer<Q: Query, S: Simd<N>>(&self, simd: S, walk: &mut dyn Together, query: &mut Q) {
        let Self { contents, unbounded, region, rays } = *self;
        let width = walk.width();
        let (mut asked, mut slabs) = (Vec::with_capacity(width), Vec::with_capacity(width));
        for (number, ray) in rays.iter().enumerate() {
            let Some(edges) = EdgeRay::new(ray, region) else {
                query.finish(number, None);
                continue;
            };
            let leaf_ray = contents.ray(ray, &edges, region);
            let mut state = query.start(number, edges.t_max);
            let answered = contents.meet_objects(unbounded, &leaf_ray, &mut None, query, &mut state);
            match SlabRay::new(None, &edges, region).filter(|_| !answered) {
                None => query.finish(number, Some((edges.along(), state))),
                Some(ready) => {
                    let LeafRay { lanes, time, .. } = leaf_ray;
                    asked.push(Asked { number, edges, lanes, time, state });
                    slabs.push(ready);
                }
            }
            if asked.len() == width {
                self.walk(simd, walk, &mut asked, &slabs, query);
                slabs.clear();
            }
        }
        if !asked.is_empty() {
            self.walk(simd, walk, &mut asked, &slabs, query);
        }
    }

    /// Walks the rays at hand, and writes down their answers.
    #[inline(always)]
    fn walk<Q: Query, S: Simd<N>>(
        &self,
        simd: S,
        walk: &mut dyn Together,
        asked: &mut Vec<Asked<Q::State>>,
        slabs: &[SlabRay],
        query: &mut Q,
    ) {
        let mut limits = [f32::NEG_INFINITY; MOST_TOGETHER];
        for ((limit, one), ray) in limits.iter_mut().zip(&*asked).zip(slabs) {
            *limit = ray.limit(Q::limit(&one.state));
        }
        walk.start(slabs);
        while let Some((leaf, mut rays)) = walk.next(&limits) {
            while rays != 0 {
                let i = rays.trailing_zeros() as usize;
                rays &= rays - 1;
                let Asked { edges, lanes, time, state, .. } = &mut asked[i];
                let ray = LeafRay { edges, lanes: *lanes, time: *time };
                let answered = self.contents.meet(simd, leaf, &ray, &mut None, query, state);
                limits[i] = if answered { f32::NEG_INFINITY } else { slabs[i].limit(Q::limit(state)) };
            }
        }
        for (i, mut one) in asked.drain(..).enumerate() {
            if Q::COUNTED {
                Q::visit_nodes(&mut one.state, walk.nodes(i));
            }
            query.finish(one.number, Some((one.edges.along(), one.state)));
        }
    }
}
