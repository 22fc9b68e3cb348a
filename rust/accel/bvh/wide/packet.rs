//! Sixteen rays together: nodes are tested against all of them at once, by intervals; only before what is below a child is
//! visited are its box and each ray tested, and where few are left they go on alone.
//!
//! The interval test: along an axis on which all rays go the same way, ray i meets the nearer plane of a box no earlier than
//! `(plane − o) · r`, with o the latest origin of all rays, moved on by the pad, and r the least or the greatest inverse
//! of all directions, whichever gives less. It errs by no more than the slab test of a single ray (`accel/slab.rs`): v·|o| for
//! rounding the origin and as much for moving it, v·(|plane| + |o|) for the difference, and 2v + v of it for the inverse and
//! the product: less than 6v·R in units of |r|. (Boulos et al., "Packet-based Whitted and Distribution Ray Tracing", 2007.)

use super::node::{Packed, WideNode};
use super::step::{Entry, nearest, pop};
use super::{WideBvh, single};
use crate::accel::SlabRay;
use crate::accel::query::Query;
use crate::math::Ray;
use crate::math::robust::{greater, lesser};
use crate::shapes::triangle::{EdgeRay, Leaf};
use crate::simd::Simd;

/// Rays of a packet: two vectors of eight lanes.
const RAYS: usize = 16;

/// So many rays or fewer go on alone.
const FEW: u32 = 4;

/// Rays of one packet, by what the tests need. One is filled again and again.
struct Packet<T> {
    edges: Vec<EdgeRay>,
    slabs: Vec<SlabRay>,
    states: Vec<T>,
    /// Which of the batch.
    rays: Vec<usize>,
    /// By axis.
    inverse: [[f32; RAYS]; 3],
    near: [[f32; RAYS]; 3],
    far: [[f32; RAYS]; 3],
    t_min: [f32; RAYS],
    /// Where in box units the query loses interest; −∞ for rays that are answered or missing.
    limit: [f32; RAYS],
    /// The plane that is met first, by axis; for all rays.
    first: [usize; 3],
    bounds: Bounds,
}

/// What holds for all rays of a packet.
struct Bounds {
    /// The origin from which the nearer plane is met last, by axis.
    near: [f32; 3],
    /// The origin from which the farther plane is met first.
    far: [f32; 3],
    /// The least inverse of a direction in magnitude, and the greatest.
    inverse: [[f32; 2]; 3],
    t_min: f32,
}

/// Answers all rays; the tree is not empty.
#[inline(always)]
pub fn answer<const N: usize, L: Leaf<N>, S: Simd<N>, Q: Query>(
    simd: S,
    bvh: &WideBvh<N, L>,
    rays: &[Ray],
    query: &mut Q,
) {
    let mut stack = vec![Entry::new(0.0, 0u32); bvh.stack];
    let mut lone = single::stack(bvh);
    let mut packet = Packet::<Q::State>::new();
    let mut start = 0;
    for chunk in rays.chunks(RAYS) {
        packet.gather(bvh, chunk, start, query);
        if packet.is_aligned() {
            packet.collect();
            packet.walk(simd, bvh, query, &mut stack, &mut lone);
        } else {
            for i in 0..packet.rays.len() {
                packet.walk_alone(simd, bvh, Packed::ROOT, i, query, &mut lone);
            }
        }
        packet.finish(query);
        start += chunk.len();
    }
}

impl<T: Copy> Packet<T> {
    fn new() -> Self {
        Self {
            edges: Vec::with_capacity(RAYS),
            slabs: Vec::with_capacity(RAYS),
            states: Vec::with_capacity(RAYS),
            rays: Vec::with_capacity(RAYS),
            inverse: [[0.0; RAYS]; 3],
            near: [[0.0; RAYS]; 3],
            far: [[0.0; RAYS]; 3],
            t_min: [0.0; RAYS],
            limit: [0.0; RAYS],
            first: [0; 3],
            bounds: Bounds { near: [0.0; 3], far: [0.0; 3], inverse: [[0.0; 2]; 3], t_min: 0.0 },
        }
    }

    /// Readies the rays that may hit something, and answers the others.
    #[inline(always)]
    fn gather<const N: usize, L: Leaf<N>, Q: Query<State = T>>(
        &mut self,
        bvh: &WideBvh<N, L>,
        rays: &[Ray],
        start: usize,
        query: &mut Q,
    ) {
        self.edges.clear();
        self.slabs.clear();
        self.states.clear();
        self.rays.clear();
        self.limit = [f32::NEG_INFINITY; RAYS];
        for (i, ray) in rays.iter().enumerate() {
            let Some((edges, slabs)) = SlabRay::prepare(ray, &bvh.region) else {
                query.finish(start + i, None);
                continue;
            };
            let state = query.start(start + i, &edges);
            self.limit[self.rays.len()] = slabs.limit(Q::limit(&state));
            self.edges.push(edges);
            self.slabs.push(slabs);
            self.states.push(state);
            self.rays.push(start + i);
        }
        if let Some(slabs) = self.slabs.first() {
            self.first = slabs.first;
        }
    }

    /// Whether all rays go the same way along every axis, and are enough to go together.
    fn is_aligned(&self) -> bool {
        self.rays.len() as u32 > FEW && self.slabs.iter().all(|s| s.first == self.first)
    }

    /// Lays the rays out by axis and finds what holds for all. Rays that are missing repeat the first.
    #[inline(always)]
    fn collect(&mut self) {
        self.bounds = Bounds {
            near: [f32::NEG_INFINITY; 3],
            far: [f32::INFINITY; 3],
            inverse: [[f32::INFINITY, 0.0]; 3],
            t_min: f32::INFINITY,
        };
        let bounds = &mut self.bounds;
        let towards = self.first.map(|first| if first == 0 { 1.0 } else { -1.0 });
        for i in 0..RAYS {
            let slabs = &self.slabs[if i < self.slabs.len() { i } else { 0 }];
            for axis in 0..3 {
                self.inverse[axis][i] = slabs.inverse[axis];
                self.near[axis][i] = slabs.near[axis];
                self.far[axis][i] = slabs.far[axis];
                let (origin, size) = (towards[axis] * slabs.origin[axis], slabs.inverse[axis].abs());
                bounds.near[axis] = greater(bounds.near[axis], origin + slabs.pad);
                bounds.far[axis] = lesser(bounds.far[axis], origin - slabs.pad);
                let [least, greatest] = bounds.inverse[axis];
                bounds.inverse[axis] = [lesser(least, size), greater(greatest, size)];
            }
            self.t_min[i] = slabs.t_min;
            bounds.t_min = lesser(bounds.t_min, slabs.t_min);
        }
        for axis in 0..3 {
            bounds.near[axis] *= towards[axis];
            bounds.far[axis] *= towards[axis];
            bounds.inverse[axis] = bounds.inverse[axis].map(|size| towards[axis] * size);
        }
    }

    /// Where the last ray loses interest.
    #[inline(always)]
    fn last_limit(&self) -> f32 {
        self.limit.iter().fold(f32::NEG_INFINITY, |a, &b| greater(b, a))
    }

    /// Visits all that any ray may hit.
    #[inline(always)]
    fn walk<const N: usize, L: Leaf<N>, S: Simd<N>, Q: Query<State = T>>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        query: &mut Q,
        stack: &mut [Entry<u32>],
        lone: &mut [Entry],
    ) {
        let mut limit = self.last_limit();
        let (mut top, mut index) = (0, 0);
        'down: loop {
            let node = &bvh.nodes[index];
            let (nears, fars) = self.interval(simd, node, limit);
            // A child is known by its node and lane, so that its box is at hand when it is popped.
            let place = (index * N) as u32;
            let mut next = nearest(simd, nears, simd.le(nears, fars), |lane| place + lane as u32, stack, &mut top);
            loop {
                let Some(place) = next.take().or_else(|| pop(stack, &mut top, limit)) else { return };
                let (parent, lane) = (&bvh.nodes[place as usize / N], place as usize & (N - 1));
                let mut active = self.meeting(simd, parent, lane);
                let child = parent.packed(lane);
                if let Some(below) = child.node() {
                    if active.count_ones() > FEW {
                        index = below;
                        continue 'down;
                    }
                    while active != 0 {
                        let i = active.trailing_zeros() as usize & (RAYS - 1);
                        active &= active - 1;
                        self.walk_alone(simd, bvh, child, i, query, lone);
                    }
                } else {
                    let (block, count) = child.block();
                    let block = &bvh.blocks[block];
                    while active != 0 {
                        let i = active.trailing_zeros() as usize & (RAYS - 1);
                        active &= active - 1;
                        let (edges, state) = (&self.edges[i], &mut self.states[i]);
                        let lanes = L::ray(simd, edges, &bvh.region);
                        Q::visit_leaf(state, count);
                        let offer = |p, candidate| query.offer(state, p, candidate);
                        let answered = block.meet(simd, &lanes, edges, count, offer);
                        self.limit[i] = if answered { f32::NEG_INFINITY } else { self.slabs[i].limit(Q::limit(state)) };
                    }
                }
                limit = self.last_limit();
            }
        }
    }

    #[inline(always)]
    fn walk_alone<const N: usize, L: Leaf<N>, S: Simd<N>, Q: Query<State = T>>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        child: Packed,
        i: usize,
        query: &mut Q,
        stack: &mut [Entry],
    ) {
        let (edges, slabs, state) = (&self.edges[i], &self.slabs[i], &mut self.states[i]);
        let answered = single::walk(simd, bvh, child, edges, slabs, query, state, stack);
        self.limit[i] = if answered { f32::NEG_INFINITY } else { slabs.limit(Q::limit(state)) };
    }

    /// From where at the earliest to where at the latest any ray is in each child.
    #[inline(always)]
    fn interval<const N: usize, S: Simd<N>>(&self, simd: S, node: &WideNode<N>, limit: f32) -> (S::F32, S::F32) {
        let mut nears = simd.splat(self.bounds.t_min);
        let mut fars = simd.splat(limit);
        for axis in 0..3 {
            let first = self.first[axis] & 1;
            let [least, greatest] =
                [simd.splat(self.bounds.inverse[axis][0]), simd.splat(self.bounds.inverse[axis][1])];
            let near = simd.sub(simd.load(&node.bounds[axis][first]), simd.splat(self.bounds.near[axis]));
            let far = simd.sub(simd.load(&node.bounds[axis][first ^ 1]), simd.splat(self.bounds.far[axis]));
            nears = simd.max(nears, simd.min(simd.mul(near, least), simd.mul(near, greatest)));
            fars = simd.min(fars, simd.max(simd.mul(far, least), simd.mul(far, greatest)));
        }
        (nears, fars)
    }

    /// The rays that meet the box in one lane of a node.
    #[inline(always)]
    fn meeting<const N: usize, S: Simd<N>>(&self, simd: S, node: &WideNode<N>, lane: usize) -> u32 {
        let mut meeting = 0;
        for part in 0..RAYS / N {
            let mut nears = simd.load(&self.t_min.as_chunks::<N>().0[part]);
            let mut fars = simd.load(&self.limit.as_chunks::<N>().0[part]);
            for axis in 0..3 {
                let first = self.first[axis] & 1;
                let inverse = simd.load(&self.inverse[axis].as_chunks::<N>().0[part]);
                let near = simd.load(&self.near[axis].as_chunks::<N>().0[part]);
                let far = simd.load(&self.far[axis].as_chunks::<N>().0[part]);
                nears = simd.max(nears, simd.mul_add(simd.splat(node.bounds[axis][first][lane]), inverse, near));
                fars = simd.min(fars, simd.mul_add(simd.splat(node.bounds[axis][first ^ 1][lane]), inverse, far));
            }
            meeting |= simd.le(nears, fars) << (part * N);
        }
        meeting
    }

    #[inline(always)]
    fn finish<Q: Query<State = T>>(&self, query: &mut Q) {
        for i in 0..self.rays.len() {
            query.finish(self.rays[i], Some((&self.edges[i], self.states[i])));
        }
    }
}
