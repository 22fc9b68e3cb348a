//! One ray after the other: for a few of them, and for those that a packet leaves behind.

use super::WideBvh;
use super::node::Packed;
use super::step::{Boxes, Stacks};
use crate::accel::query::Query;
use crate::accel::slab::{Clock, SlabRay};
use crate::math::Ray;
use crate::shapes::triangle::{BlockRay, EdgeRay, Leaves};
use crate::simd::Simd;

/// Answers all rays; the tree is not empty.
#[inline(always)]
pub fn answer<const N: usize, L: Leaves<N>, S: Simd<N>, Q: Query>(
    simd: S,
    bvh: &WideBvh<N, L>,
    rays: &[Ray],
    query: &mut Q,
) {
    let mut stacks = Stacks::spare::<N>(bvh.stack);
    for (i, ray) in rays.iter().enumerate() {
        ask(simd, bvh, ray, i, query, &mut stacks);
    }
    stacks.put_away();
}

/// Answers ray `i` of a batch.
#[inline(always)]
pub fn ask<const N: usize, L: Leaves<N>, S: Simd<N>, Q: Query>(
    simd: S,
    bvh: &WideBvh<N, L>,
    ray: &Ray,
    i: usize,
    query: &mut Q,
    stacks: &mut Stacks,
) {
    let Some((edges, slabs)) = SlabRay::prepare(ray, &bvh.region) else {
        query.finish(i, None);
        return;
    };
    let mut state = query.start(i, edges.t_max);
    let lanes = L::ray(&edges, &bvh.region);
    let boxes = Boxes::new(&slabs, slabs.limit(Q::limit(&state)), Packed::ROOT, 0);
    let alone = Alone { lanes: &lanes, edges: &edges, clock: slabs.clock };
    alone.walk(simd, bvh, boxes, query, &mut state, stacks);
    query.finish(i, Some((edges.along(), state)));
}

/// A ray, ready for everything.
pub struct Alone<'a> {
    pub lanes: &'a BlockRay,
    pub edges: &'a EdgeRay,
    pub clock: Clock,
}

impl Alone<'_> {
    /// Visits all from where `ray` is, with an empty stack at the front of `stacks`; true if the question is answered.
    #[inline(always)]
    pub fn walk<const N: usize, L: Leaves<N>, S: Simd<N>, Q: Query>(
        &self,
        simd: S,
        bvh: &WideBvh<N, L>,
        mut ray: Boxes,
        query: &mut Q,
        state: &mut Q::State,
        stacks: &mut Stacks,
    ) -> bool {
        loop {
            match ray.at.kind() {
                0 => {
                    Q::visit_node(state);
                    let node = &bvh.nodes[ray.at.node()];
                    if Q::NEAREST_FIRST {
                        ray.enter::<N, S, true>(simd, node, stacks);
                    } else {
                        ray.enter::<N, S, false>(simd, node, stacks);
                    }
                }
                1 => {
                    let (first, count) = ray.at.leaf();
                    Q::visit_leaf(state, count);
                    let before = Q::limit(state);
                    let offer = |p, candidate| query.offer(state, p, candidate);
                    if bvh.leaves.meet(simd, first, count, self.lanes, self.edges, offer) {
                        return true;
                    }
                    if Q::limit(state) < before {
                        ray.shorten(simd, self.clock.limit(Q::limit(state)), stacks, 0);
                    }
                    ray.pop(stacks);
                }
                _ => return false,
            }
        }
    }
}
