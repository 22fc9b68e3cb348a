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
    let mut stack = vec![Entry::NONE; bvh.stack];
    for (i, ray) in rays.iter().enumerate() {
        match SlabRay::prepare(ray, bvh.extent, bvh.box_scale) {
            Some((edges, slabs)) => {
                let state = walk::<N, S, Q>(simd, bvh, &edges, &slabs, &mut stack);
                out.finish(i, Some((&edges, state)));
            }
            None => out.finish(i, None),
        }
    }
}

#[inline(always)]
fn walk<const N: usize, S: Simd<N>, Q: Query<N>>(
    simd: S,
    bvh: &WideBvh<N>,
    edges: &EdgeRay,
    slabs: &SlabRay,
    stack: &mut [Entry],
) -> Q::State {
    let (boxes, triangles) = (SlabLanes::new(simd, slabs), BlockRay::new(simd, edges));
    let mut state = Q::start(edges);
    let mut limit = slabs.limit(Q::limit(&state));
    let mut top = 0;
    let mut child = Packed::ROOT;
    loop {
        let below = if let Some(index) = child.node() {
            boxes.descend(simd, &bvh.nodes[index], limit, stack, &mut top)
        } else {
            let (index, count) = child.block();
            if Q::test(simd, &bvh.blocks[index], count, LeafRay { lanes: &triangles, edges }, &mut state) {
                return state;
            }
            limit = slabs.limit(Q::limit(&state));
            None
        };
        match below.or_else(|| pop(stack, &mut top, limit)) {
            Some(next) => child = next,
            None => return state,
        }
    }
}
