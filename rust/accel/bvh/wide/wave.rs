//! Many rays in flight on one thread: one takes a step, a node or a leaf; what it needs next is fetched from memory
//! while the others take theirs.
//!
//! A ray that waits for memory at every step, and for the outcome of every branch, leaves most of the processor idle.
//! So each of 64 rays has a stack of its own; those that are at a node wait in one queue, those at a leaf in another;
//! and a step at a node has no branch that depends on the ray ([`Boxes::enter`]). Only when a ray has hit something is
//! its stack rid of what lies beyond.

use super::WideBvh;
use super::node::Packed;
use super::step::{Boxes, Stacks};
use crate::accel::query::Query;
use crate::accel::slab::{Clock, SlabRay};
use crate::math::Ray;
use crate::shapes::triangle::{BlockRay, EdgeRay, Leaves};
use crate::simd::Simd;

/// Rays in flight: enough that what one has asked for is there when its turn comes.
const WAVE: usize = 64;

/// What a ray needs at leaves, and to say what it has found.
struct Flight<T> {
    lanes: BlockRay,
    edges: EdgeRay,
    clock: Clock,
    state: T,
    /// Which of the batch.
    ray: usize,
}

/// The places of rays that wait for the same kind of step: at a node, or at a leaf and done.
struct Queues {
    places: [[u8; WAVE]; 2],
    lens: [usize; 2],
}

impl Queues {
    /// Both queues are written and one grows: no branch, and no address that waits for the kind.
    #[inline(always)]
    fn push(&mut self, kind: usize, place: usize) {
        self.places[0][self.lens[0] & (WAVE - 1)] = place as u8;
        self.places[1][self.lens[1] & (WAVE - 1)] = place as u8;
        self.lens[0] += 1 - kind;
        self.lens[1] += kind;
    }

    /// All that wait in one; it is empty then.
    #[inline(always)]
    fn take(&mut self, queue: usize) -> ([u8; WAVE], usize) {
        (self.places[queue], std::mem::take(&mut self.lens[queue]).min(WAVE))
    }
}

/// Answers all rays, of which there is at least one; the tree is not empty.
#[inline(always)]
pub fn answer<const N: usize, L: Leaves<N>, S: Simd<N>, Q: Query>(
    simd: S,
    bvh: &WideBvh<N, L>,
    rays: &[Ray],
    query: &mut Q,
) {
    let width = WAVE.min(rays.len());
    // As many as there can be, so that no place of a queue is out of bounds.
    let mut boxes = [Boxes::NOWHERE; WAVE];
    let mut flights: Vec<Flight<Q::State>> = Vec::with_capacity(width);
    let mut stacks = Stacks::new::<N>(width, bvh.stack);
    let mut queues = Queues { places: [[0; WAVE]; 2], lens: [0; 2] };
    let mut next = 0;
    while flights.len() < width
        && let Some((b, flight)) = launch(bvh, rays, &mut next, stacks.bottom(flights.len()), query)
    {
        queues.push(0, flights.len());
        boxes[flights.len()] = b;
        flights.push(flight);
    }
    while queues.lens != [0; 2] {
        let (places, len) = queues.take(0);
        for &place in &places[..len] {
            let place = place as usize;
            let ray = &mut boxes[place & (WAVE - 1)];
            let node = &bvh.nodes[ray.at.node()];
            if Q::NEAREST_FIRST {
                ray.enter::<N, S, true>(simd, node, &mut stacks);
            } else {
                ray.enter::<N, S, false>(simd, node, &mut stacks);
            }
            queues.push(ray.at.is_leaf(), place);
            fetch(simd, bvh, ray.at);
        }
        let (places, len) = queues.take(1);
        for &place in &places[..len] {
            let place = place as usize;
            let (ray, flight) = (&mut boxes[place & (WAVE - 1)], &mut flights[place]);
            let bottom = stacks.bottom(place);
            let Flight { lanes, edges, clock, state, .. } = flight;
            let mut done = ray.at == Packed::NONE;
            if !done {
                let (first, count) = ray.at.leaf();
                let before = Q::limit(state);
                let offer = |p, candidate| query.offer(state, p, candidate);
                done = bvh.leaves.meet(simd, first, count, lanes, edges, offer);
                if Q::limit(state) < before {
                    ray.shorten(simd, clock.limit(Q::limit(state)), &mut stacks, bottom);
                }
            }
            if done {
                query.finish(flight.ray, Some((flight.edges.along(), flight.state)));
                if let Some((b, new)) = launch(bvh, rays, &mut next, bottom, query) {
                    boxes[place & (WAVE - 1)] = b;
                    *flight = new;
                    queues.push(0, place);
                }
            } else {
                ray.pop(&stacks);
                queues.push(ray.at.is_leaf(), place);
                fetch(simd, bvh, ray.at);
            }
        }
    }
}

/// Asks for what a reference stands for.
#[inline(always)]
fn fetch<const N: usize, L: Leaves<N>, S: Simd<N>>(simd: S, bvh: &WideBvh<N, L>, at: Packed) {
    let leaf = bvh.leaves.place(at.leaf().0);
    let node = bvh.nodes.as_ptr().wrapping_add(at.node()).cast::<u8>();
    simd.prefetch(if at.is_leaf() == 1 { leaf } else { node }, 4);
}

/// The next ray of the batch that may hit something; the others are answered at once.
#[inline(always)]
fn launch<const N: usize, L: Leaves<N>, Q: Query>(
    bvh: &WideBvh<N, L>,
    rays: &[Ray],
    next: &mut usize,
    bottom: usize,
    query: &mut Q,
) -> Option<(Boxes, Flight<Q::State>)> {
    while *next < rays.len() {
        let ray = *next;
        *next += 1;
        if let Some((edges, slabs)) = SlabRay::prepare(&rays[ray], &bvh.region) {
            let state = query.start(ray, edges.t_max);
            let boxes = Boxes::new(&slabs, slabs.limit(Q::limit(&state)), Packed::ROOT, bottom);
            let lanes = L::ray(&edges, &bvh.region);
            return Some((boxes, Flight { lanes, edges, clock: slabs.clock, state, ray }));
        }
        query.finish(ray, None);
    }
    None
}
