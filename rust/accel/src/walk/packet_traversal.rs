//! Packet traversal of structures, leaf by leaf. Each ray keeps its own result and limit, and is tested by itself in a
//! leaf.

use super::leaf_contents::{Contents, LeafRay};
use crate::SlabRay;
use crate::query::Query;
use raywright_base::math::{Ray, Region};
use raywright_base::simd::Simd;
use raywright_shapes::triangle::{BlockRay, EdgeRay, Leaves};

/// Maximum number of rays in a packet.
pub const MOST_TOGETHER: usize = 64;

/// Traverses a structure with packets of rays.
pub trait Together {
    /// Maximum number of rays, up to [`MOST_TOGETHER`].
    fn width(&self) -> usize;

    /// Start a packet of at least one ray.
    fn start(&mut self, rays: &[SlabRay]);

    /// Return the next nonempty leaf that some rays may hit, each at a `t` of at most its limit, in box units, with a
    /// bit mask of these rays. Finished and missing rays have a limit of −∞ and are never in the mask. No leaf is
    /// returned twice.
    fn next(&mut self, limits: &[f32; MOST_TOGETHER]) -> Option<(u32, u64)>;

    /// Nodes visited since the start for a ray; 0 if not counted. A test of all rays counts for the first one only.
    fn nodes(&self, ray: usize) -> u32;
}

/// A ray of the current packet.
struct Asked<T> {
    /// Its index in the batch.
    number: usize,
    edges: EdgeRay,
    lanes: BlockRay,
    time: f64,
    state: T,
}

/// A batch of rays and the scene.
pub struct TogetherBatch<'a, const N: usize, L> {
    pub contents: &'a Contents<N, L>,
    /// Objects tested against every ray.
    pub unbounded: &'a [u32],
    pub region: &'a Region,
    pub rays: &'a [Ray],
}

impl<const N: usize, L: Leaves<N>> TogetherBatch<'_, N, L> {
    /// Run a query on all rays.
    ///
    /// A primitive in several leaves may be offered more than once, which does not change results. Mailboxes would be
    /// needed for every ray of the packet.
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

    /// Traverse the current packet and store its results.
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
