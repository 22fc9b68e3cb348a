//! One ray after the other: best where each needs what the last one needed.

use super::WideBvh;
use super::node::Packed;
use super::step::{Entry, SlabLanes, pop};
use crate::accel::SlabRay;
use crate::accel::query::Query;
use crate::math::Ray;
use crate::shapes::triangle::{EdgeRay, Leaf};
use crate::simd::Simd;

/// Answers all rays; the tree is not empty.
#[inline(always)]
pub fn answer<const N: usize, L: Leaf<N>, S: Simd<N>, Q: Query>(
    simd: S,
    bvh: &WideBvh<N, L>,
    rays: &[Ray],
    query: &mut Q,
) {
    let mut stack = stack(bvh);
    for (i, ray) in rays.iter().enumerate() {
        match SlabRay::prepare(ray, &bvh.region) {
            Some((edges, slabs)) => {
                let mut state = query.start(i, &edges);
                walk(simd, bvh, Packed::ROOT, &edges, &slabs, query, &mut state, &mut stack);
                query.finish(i, Some((&edges, state)));
            }
            None => query.finish(i, None),
        }
    }
}

/// A stack deep enough for a walk.
pub fn stack<const N: usize, L>(bvh: &WideBvh<N, L>) -> Vec<Entry> {
    vec![Entry::new(0.0, Packed::ROOT); bvh.stack]
}

/// Visits what is below `child`; true if the question is answered.
#[inline(always)]
#[allow(clippy::too_many_arguments)]
pub fn walk<const N: usize, L: Leaf<N>, S: Simd<N>, Q: Query>(
    simd: S,
    bvh: &WideBvh<N, L>,
    mut child: Packed,
    edges: &EdgeRay,
    slabs: &SlabRay,
    query: &mut Q,
    state: &mut Q::State,
    stack: &mut [Entry],
) -> bool {
    let (boxes, lanes) = (SlabLanes::new(simd, slabs), L::ray(simd, edges, &bvh.region));
    let mut limit = slabs.limit(Q::limit(state));
    let mut top = 0;
    loop {
        let below = if let Some(index) = child.node() {
            Q::visit_node(state);
            boxes.descend(simd, &bvh.nodes[index], limit, stack, &mut top)
        } else {
            let (index, count) = child.block();
            Q::visit_leaf(state, count);
            if bvh.blocks[index].meet(simd, &lanes, edges, count, |p, candidate| query.offer(state, p, candidate)) {
                return true;
            }
            limit = slabs.limit(Q::limit(state));
            None
        };
        match below.or_else(|| pop(stack, &mut top, limit)) {
            Some(next) => child = next,
            None => return false,
        }
    }
}
