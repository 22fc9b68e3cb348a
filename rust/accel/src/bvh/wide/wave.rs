//! Waves of many rays in flight on one thread: one takes a step, at a node or a leaf; the data of its next step are
//! prefetched while the others take theirs.
//!
//! A ray that waits for memory at every step, and for the outcome of every branch, leaves most of the processor idle.
//! So each of many rays has a stack of its own. Rays at a node wait in one queue, those at a leaf in another, and a
//! step at a node has no branch that depends on the ray ([`Boxes::enter`]). Only after a hit is a ray's stack cleared
//! of entries beyond it.

use super::WideBvh;
use super::leaf_visitor::{Errand, Visited, enter};
use super::node::Packed;
use super::ray_setup::Gate;
use super::step::{Boxes, Stacks};
use raywright_base::math::RayBatch;
use raywright_base::simd::Simd;
use raywright_shapes::triangle::Leaves;

/// Rays in flight: enough to hide the latency of prefetches.
const WAVE: usize = 32;

/// The number of rays that test the children of their nodes before any of them reads its next child. That read waits
/// for the whole test, and so would all later instructions in flight, about four steps. (Processing the whole queue is
/// slower if memory latency is high, since all prefetches are issued at once. The same at leaves, with f32 results
/// stored until all are tested, is no faster: they have to be written and read again.)
const TOGETHER: usize = 8;

/// The indices of rays that wait for the same kind of step: at a node, or at a leaf or done.
struct Queues {
    places: [[u8; WAVE]; 2],
    lens: [usize; 2],
}

impl Queues {
    /// Both queues are written and one grows, which avoids a branch and an address that depends on the kind.
    #[inline(always)]
    fn push(&mut self, kind: usize, place: usize) {
        self.places[0][self.lens[0] & (WAVE - 1)] = place as u8;
        self.places[1][self.lens[1] & (WAVE - 1)] = place as u8;
        self.lens[0] += 1 - kind;
        self.lens[1] += kind;
    }

    /// Take all indices from a queue.
    #[inline(always)]
    fn take(&mut self, queue: usize) -> ([u8; WAVE], usize) {
        (self.places[queue], std::mem::take(&mut self.lens[queue]).min(WAVE))
    }
}

/// Process at least one ray, for a nonempty tree.
#[inline(always)]
pub fn answer<const N: usize, L: Leaves<N>, S: Simd<N>, E: Errand<N, L>>(
    simd: S,
    bvh: &WideBvh<N, L>,
    rays: &RayBatch<'_>,
    errand: &mut E,
) {
    let mut gate = Gate::new(bvh, rays);
    let width = WAVE.min(rays.len());
    // The full size, so that no index of a queue is out of bounds.
    let mut boxes = [Boxes::NOWHERE; WAVE];
    let mut flights: Vec<E::Flight> = Vec::with_capacity(width);
    let mut stacks = Stacks::new::<N>(width, bvh.stack);
    let mut queues = Queues { places: [[0; WAVE]; 2], lens: [0; 2] };
    while flights.len() < width
        && let Some((b, flight)) = gate.launch(simd, bvh, stacks.bottom(flights.len()), errand)
    {
        queues.push(0, flights.len());
        boxes[flights.len()] = b;
        flights.push(flight);
    }
    while queues.lens != [0; 2] {
        let (places, len) = queues.take(0);
        for together in places[..len].chunks(TOGETHER) {
            for &place in together {
                let ray = &mut boxes[usize::from(place) & (WAVE - 1)];
                enter::<N, L, S, E>(simd, ray, &bvh.nodes[ray.at.node()], &mut stacks);
            }
            for &place in together {
                let place = usize::from(place);
                let ray = &mut boxes[place & (WAVE - 1)];
                ray.pop(&stacks);
                queues.push(ray.at.is_leaf(), place);
                fetch(simd, bvh, ray.at);
            }
        }
        let (places, len) = queues.take(1);
        for &place in &places[..len] {
            let place = place as usize;
            let (ray, flight) = (&mut boxes[place & (WAVE - 1)], &mut flights[place]);
            let bottom = stacks.bottom(place);
            let mut done = ray.at == Packed::NONE;
            if !done {
                match errand.visit(simd, bvh, flight, ray.at) {
                    Visited::Nothing => {}
                    Visited::Until(limit) => {
                        ray.shorten(simd, ray.clock(&bvh.region).limit(limit), &mut stacks, bottom);
                    }
                    Visited::Answered => done = true,
                }
            }
            if done {
                errand.finish(simd, bvh, flight);
                if let Some((b, new)) = gate.launch(simd, bvh, bottom, errand) {
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
    errand.end(simd, bvh);
}

/// Prefetch a child.
#[inline(always)]
pub fn fetch<const N: usize, L: Leaves<N>, S: Simd<N>>(simd: S, bvh: &WideBvh<N, L>, at: Packed) {
    let leaf = bvh.leaves.place(at.leaf().0);
    let node = bvh.nodes.as_ptr().wrapping_add(at.node()).cast::<u8>();
    // The lines of a node, and of most leaves, which may begin anywhere in a line. Prefetching exactly the needed lines
    // takes up to a tenth longer.
    simd.prefetch(if at.is_leaf() == 1 { leaf } else { node }, 5);
}
