//! Many rays in flight on one thread: one takes a step, a node or a block; what it needs next is fetched from memory
//! while the others take theirs.
//!
//! A ray that waits for memory at every step leaves most of the processor idle: with 64 in flight a thread answers one and a
//! half to twice as many incoherent rays of a large scene. Coherent ones find what they need in the nearest cache, and have
//! less to carry about one after the other.

use super::WideBvh;
use super::node::Packed;
use super::step::{Entry, SlabLanes, pop};
use crate::accel::SlabRay;
use crate::accel::query::Query;
use crate::math::Ray;
use crate::shapes::triangle::{EdgeRay, Leaf};
use crate::simd::Simd;

/// Rays in flight: enough that what one has asked for is there when its turn comes.
const WAVE: usize = 64;

/// A ray on its way.
struct Flight<T> {
    edges: EdgeRay,
    slabs: SlabRay,
    state: T,
    /// Where in box units the query loses interest.
    limit: f32,
    /// Where it is.
    child: Packed,
    /// Entries on its stack.
    top: usize,
    /// Which of the batch.
    ray: usize,
    /// Which stack is its own.
    stack: usize,
}

/// Answers all rays, of which there is at least one; the tree is not empty.
#[inline(always)]
pub fn answer<const N: usize, L: Leaf<N>, S: Simd<N>, Q: Query>(
    simd: S,
    bvh: &WideBvh<N, L>,
    rays: &[Ray],
    query: &mut Q,
) {
    let width = WAVE.min(rays.len());
    let mut stacks = vec![Entry::new(0.0, Packed::ROOT); bvh.stack * width];
    let mut flights: Vec<Flight<Q::State>> = Vec::with_capacity(width);
    let mut next = 0;
    while flights.len() < width {
        let stack = flights.len() * bvh.stack;
        match launch(bvh, rays, &mut next, stack, query) {
            Some(flight) => flights.push(flight),
            None => break,
        }
    }
    while !flights.is_empty() {
        let mut i = 0;
        while i < flights.len() {
            let flight = &mut flights[i];
            let stack = &mut stacks[flight.stack..flight.stack + bvh.stack];
            if step(simd, bvh, flight, stack, query) {
                i += 1;
                continue;
            }
            query.finish(flight.ray, Some((&flight.edges, flight.state)));
            match launch(bvh, rays, &mut next, flight.stack, query) {
                Some(new) => *flight = new,
                None => {
                    flights.swap_remove(i);
                }
            }
        }
    }
}

/// The next ray of the batch that may hit something; the others are answered at once.
#[inline(always)]
fn launch<const N: usize, L: Leaf<N>, Q: Query>(
    bvh: &WideBvh<N, L>,
    rays: &[Ray],
    next: &mut usize,
    stack: usize,
    query: &mut Q,
) -> Option<Flight<Q::State>> {
    while *next < rays.len() {
        let ray = *next;
        *next += 1;
        if let Some((edges, slabs)) = SlabRay::prepare(&rays[ray], &bvh.region) {
            let state = query.start(ray, &edges);
            let limit = slabs.limit(Q::limit(&state));
            return Some(Flight { edges, slabs, state, limit, child: Packed::ROOT, top: 0, ray, stack });
        }
        query.finish(ray, None);
    }
    None
}

/// Visits one node or block; false if the ray is answered.
#[inline(always)]
fn step<const N: usize, L: Leaf<N>, S: Simd<N>, Q: Query>(
    simd: S,
    bvh: &WideBvh<N, L>,
    flight: &mut Flight<Q::State>,
    stack: &mut [Entry],
    query: &mut Q,
) -> bool {
    let below = if let Some(index) = flight.child.node() {
        Q::visit_node(&mut flight.state);
        let lanes = SlabLanes::new(simd, &flight.slabs);
        lanes.descend(simd, &bvh.nodes[index], flight.limit, stack, &mut flight.top)
    } else {
        let (index, count) = flight.child.block();
        let (edges, state) = (&flight.edges, &mut flight.state);
        let lanes = L::ray(simd, edges, &bvh.region);
        Q::visit_leaf(state, count);
        if bvh.blocks[index].meet(simd, &lanes, edges, count, |p, candidate| query.offer(state, p, candidate)) {
            return false;
        }
        flight.limit = flight.slabs.limit(Q::limit(&flight.state));
        None
    };
    let Some(child) = below.or_else(|| pop(stack, &mut flight.top, flight.limit)) else { return false };
    match child.node() {
        Some(index) => simd.prefetch(&bvh.nodes[index]),
        None => simd.prefetch(&bvh.blocks[child.block().0]),
    }
    flight.child = child;
    true
}
