//! Traversal by single rays: for few rays, and for those that remain of a packet.

use super::WideBvh;
use super::leaf_visitor::{Errand, Visited, enter};
use super::node::Packed;
use super::step::{Boxes, Stacks};
use crate::slab::SlabRay;
use raywright_base::math::RayBatch;
use raywright_base::simd::Simd;
use raywright_shapes::triangle::Leaves;

/// Process all rays, for a nonempty tree.
#[inline(always)]
pub fn answer<const N: usize, L: Leaves<N>, S: Simd<N>, E: Errand<N, L>>(
    simd: S,
    bvh: &WideBvh<N, L>,
    rays: &RayBatch<'_>,
    errand: &mut E,
) {
    let mut stacks = Stacks::spare::<N>(bvh.stack);
    for i in 0..rays.len() {
        ask(simd, bvh, rays, i, errand, &mut stacks);
    }
    stacks.put_away();
    errand.end(simd, bvh);
}

/// Process ray `i` of a batch.
#[inline(always)]
pub fn ask<const N: usize, L: Leaves<N>, S: Simd<N>, E: Errand<N, L>>(
    simd: S,
    bvh: &WideBvh<N, L>,
    rays: &RayBatch<'_>,
    i: usize,
    errand: &mut E,
    stacks: &mut Stacks,
) {
    let Some((edges, slabs)) = SlabRay::prepare(bvh.axes.as_ref(), &rays.get(i), &bvh.region) else {
        errand.miss(i);
        return;
    };
    let mut flight = errand.start(bvh, i, &edges);
    let boxes = Boxes::new(&slabs, slabs.limit(E::limit(bvh, &flight)), Packed::ROOT, 0);
    walk(simd, bvh, boxes, errand, &mut flight, stacks);
    errand.finish(simd, bvh, &flight);
}

/// Traverse from the current node of a ray, with an empty stack at the front of `stacks`. Return true if the query is
/// done.
#[inline(always)]
pub fn walk<const N: usize, L: Leaves<N>, S: Simd<N>, E: Errand<N, L>>(
    simd: S,
    bvh: &WideBvh<N, L>,
    mut ray: Boxes,
    errand: &mut E,
    flight: &mut E::Flight,
    stacks: &mut Stacks,
) -> bool {
    loop {
        match ray.at.kind() {
            0 => {
                E::visit_node(flight);
                let node = &bvh.nodes[ray.at.node()];
                enter::<N, L, S, E>(simd, &mut ray, node, stacks);
                ray.pop(stacks);
            }
            1 => {
                match errand.visit(simd, bvh, flight, ray.at) {
                    Visited::Nothing => {}
                    Visited::Until(limit) => ray.shorten(simd, ray.clock(&bvh.region).limit(limit), stacks, 0),
                    Visited::Answered => return true,
                }
                ray.pop(stacks);
            }
            _ => return false,
        }
    }
}
