//! One ray after the other: best where each needs what the last one needed.

use super::WideBvh;
use super::node::Packed;
use super::query::{LeafRay, Query};
use super::step::{Entry, SlabLanes, pop};
use crate::accel::SlabRay;
use crate::math::Ray;
use crate::shapes::triangle::{BlockRay, EdgeRay};
use crate::simd::Simd;

/// Answers all rays; the tree is not empty.
#[inline(always)]
pub fn answer<const N: usize, S: Simd<N>, Q: Query<N>>(simd: S, bvh: &WideBvh<N>, rays: &[Ray], out: &mut Q) {
    let mut stack = stack(bvh);
    for (i, ray) in rays.iter().enumerate() {
        match SlabRay::prepare(ray, bvh.extent, bvh.box_scale) {
            Some((edges, slabs)) => {
                let mut state = Q::start(&edges);
                walk::<N, S, Q>(simd, bvh, Packed::ROOT, &edges, &slabs, &mut state, &mut stack);
                out.finish(i, Some((&edges, state)));
            }
            None => out.finish(i, None),
        }
    }
}

/// A stack deep enough for a walk.
pub fn stack<const N: usize>(bvh: &WideBvh<N>) -> Vec<Entry> {
    vec![Entry::new(0.0, Packed::ROOT); bvh.stack]
}

/// Visits what is below `child`; true if the question is answered.
#[inline(always)]
pub fn walk<const N: usize, S: Simd<N>, Q: Query<N>>(
    simd: S,
    bvh: &WideBvh<N>,
    mut child: Packed,
    edges: &EdgeRay,
    slabs: &SlabRay,
    state: &mut Q::State,
    stack: &mut [Entry],
) -> bool {
    let (boxes, triangles) = (SlabLanes::new(simd, slabs), BlockRay::new(simd, edges));
    let mut limit = slabs.limit(Q::limit(state));
    let mut top = 0;
    loop {
        let below = if let Some(index) = child.node() {
            boxes.descend(simd, &bvh.nodes[index], limit, stack, &mut top)
        } else {
            let (index, count) = child.block();
            if Q::test(simd, &bvh.blocks[index], count, LeafRay { lanes: &triangles, edges }, state) {
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
