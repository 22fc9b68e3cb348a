//! Sixteen rays together: nodes are tested against all of them at once, by intervals; only before what is below a child
//! is visited are its box and each ray tested, and where few are left they go on alone. (Boulos et al., "Packet-based
//! Whitted and Distribution Ray Tracing", 2007.) In leaves, a triangle is tested against all rays, or a ray against all
//! triangles, whichever is less work.
//!
//! The interval test: along an axis on which all rays go the same way, ray i meets the nearer plane of a box no earlier
//! than `(plane − o) · r`, with o the latest origin of all rays, moved on by the pad, and r the least or the greatest
//! inverse of all directions, whichever gives less. It errs by no more than the slab test of a single ray
//! (`accel/slab.rs`): v·|o| for rounding the origin and as much for moving it, v·(|plane| + |o|) for the difference,
//! and 2v + v of it for the inverse and the product: less than 6v·R in units of |r|.

use super::WideBvh;
use super::node::{Packed, WideNode};
use super::single::{self, Alone};
use super::step::{Boxes, Stacks};
use crate::accel::query::Query;
use crate::accel::slab::{Clock, SlabRays};
use crate::math::Ray;
use crate::math::robust::{greater, lesser};
use crate::shapes::triangle::{ALL, Along, Column, EdgeRays, Leaves, RAYS, Sixteen};
use crate::simd::Simd;

/// So many rays or fewer go on alone.
const FEW: u32 = 4;

/// Rays of one packet, all plain ([`EdgeRays::prepare`]) and going the same way along every axis.
struct Packet<'a, T> {
    rays: Sixteen<'a>,
    slabs: &'a SlabRays,
    states: [T; RAYS],
    /// Where in box units the query loses interest; −∞ for rays that are answered or missing.
    limit: Column<f32>,
    bounds: Bounds,
    /// The plane that is met first, by axis; for all rays.
    first: [usize; 3],
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

/// A child that is still to be visited, known by its node and lane, and from where on.
#[derive(Clone, Copy)]
struct Entry {
    near: f32,
    place: u32,
}

/// Answers all rays; the tree is not empty.
#[inline(always)]
pub fn answer<const N: usize, L: Leaves<N>, S: Simd<N>, Q: Query>(
    simd: S,
    bvh: &WideBvh<N, L>,
    rays: &[Ray],
    query: &mut Q,
) {
    let mut stack = vec![Entry { near: 0.0, place: 0 }; bvh.stack];
    let mut lone = Stacks::new::<N>(1, bvh.stack);
    // The next packet's columns are written before this one is walked: a wide load must wait for narrow stores.
    let mut edges = [EdgeRays::default(), EdgeRays::default()];
    let mut slabs = SlabRays::default();
    edges[0].transpose(&rays[..rays.len().min(RAYS)]);
    for (turn, chunk) in rays.chunks(RAYS).enumerate() {
        let start = turn * RAYS;
        if start + RAYS < rays.len() {
            edges[(turn + 1) & 1].transpose(&rays[start + RAYS..rays.len().min(start + 2 * RAYS)]);
        }
        let edges = &mut edges[turn & 1];
        let mut first = None;
        if chunk.len() as u32 > FEW && edges.prepare(&bvh.region) {
            slabs.prepare(edges, &bvh.region);
            first = slabs.first();
        }
        let Some(first) = first else {
            for (i, ray) in chunk.iter().enumerate() {
                single::ask(simd, bvh, ray, start + i, query, &mut lone);
            }
            continue;
        };
        let blocks = L::rays(edges, &bvh.region);
        let mut packet = Packet {
            rays: Sixteen { given: chunk, region: &bvh.region, edges, blocks: &blocks },
            slabs: &slabs,
            states: [query.start(start, edges.t_max[0]); RAYS],
            limit: [f32::NEG_INFINITY; RAYS],
            bounds: Bounds::of(simd, &slabs, first),
            first,
        };
        for i in 0..chunk.len() {
            packet.states[i] = query.start(start + i, edges.t_max[i]);
            packet.limit[i] = Clock::of(&bvh.region).limit(Q::limit(&packet.states[i]));
        }
        packet.walk(simd, bvh, query, &mut stack, &mut lone);
        for i in 0..chunk.len() {
            let along = Along { scale: edges.scale[i], largest: edges.largest[i] };
            query.finish(start + i, Some((along, packet.states[i])));
        }
    }
}

/// The least and the greatest of sixteen numbers without NaN, of which there are `16 / N` vectors.
#[inline(always)]
fn least<const N: usize, S: Simd<N>>(simd: S, column: &Column<f32>) -> f32 {
    let parts = column.as_chunks::<N>().0;
    let mut all = simd.load(&parts[0]);
    for part in &parts[1..] {
        all = simd.min(all, simd.load(part));
    }
    let mut lanes = [0f32; N];
    simd.store(all, &mut lanes);
    let mut half = [0f32; 4];
    for i in 0..4 {
        half[i] = lesser(lanes[i], lanes[N - 4 + i]);
    }
    lesser(lesser(half[0], half[1]), lesser(half[2], half[3]))
}

/// The greatest of a column without NaN.
#[inline(always)]
fn greatest<const N: usize, S: Simd<N>>(simd: S, column: &Column<f32>) -> f32 {
    let parts = column.as_chunks::<N>().0;
    let mut all = simd.load(&parts[0]);
    for part in &parts[1..] {
        all = simd.max(all, simd.load(part));
    }
    let mut lanes = [0f32; N];
    simd.store(all, &mut lanes);
    let mut half = [0f32; 4];
    for i in 0..4 {
        half[i] = greater(lanes[i], lanes[N - 4 + i]);
    }
    greater(greater(half[0], half[1]), greater(half[2], half[3]))
}

impl Bounds {
    #[inline(always)]
    fn of<const N: usize, S: Simd<N>>(simd: S, slabs: &SlabRays, first: [usize; 3]) -> Self {
        let mut bounds =
            Self { near: [0.0; 3], far: [0.0; 3], inverse: [[0.0; 2]; 3], t_min: least(simd, &slabs.t_min) };
        for axis in 0..3 {
            let towards = if first[axis] == 0 { 1.0 } else { -1.0 };
            let (mut near, mut far, mut size) = ([0.0; RAYS], [0.0; RAYS], [0.0; RAYS]);
            for i in 0..RAYS {
                let origin = towards * slabs.origin[axis][i];
                near[i] = origin + slabs.pad[i];
                far[i] = origin - slabs.pad[i];
                size[i] = slabs.inverse[axis][i].abs();
            }
            bounds.near[axis] = greatest(simd, &near) * towards;
            bounds.far[axis] = least(simd, &far) * towards;
            bounds.inverse[axis] = [least(simd, &size) * towards, greatest(simd, &size) * towards];
        }
        bounds
    }
}

impl<T: Copy> Packet<'_, T> {
    /// Where the last ray loses interest.
    #[inline(always)]
    fn last_limit<const N: usize, S: Simd<N>>(&self, simd: S) -> f32 {
        greatest(simd, &self.limit)
    }

    /// Visits all that any ray may hit.
    #[inline(always)]
    fn walk<const N: usize, L: Leaves<N>, S: Simd<N>, Q: Query<State = T>>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        query: &mut Q,
        stack: &mut [Entry],
        lone: &mut Stacks,
    ) {
        let mut limit = self.last_limit(simd);
        let (mut top, mut index) = (0, 0);
        'down: loop {
            let node = &bvh.nodes[index];
            let (nears, fars) = self.interval(simd, node, limit);
            // A child is known by its node and lane, so that its box is at hand when it is popped.
            let place = (index * N) as u32;
            let mut next = nearest(simd, nears, simd.le(nears, fars), place, stack, &mut top);
            loop {
                let Some(place) = next.take().or_else(|| pop(stack, &mut top, limit)) else { return };
                let (parent, lane) = (&bvh.nodes[place as usize / N], place as usize & (N - 1));
                let mut active = self.meeting(simd, parent, lane);
                let child = Packed::of(parent.children[lane]);
                if child.is_leaf() == 1 {
                    if active != 0 {
                        let (first, count) = child.leaf();
                        self.visit_leaf(simd, bvh, first, count, active, query);
                        limit = self.last_limit(simd);
                    }
                    continue;
                }
                if active.count_ones() > FEW {
                    index = child.node();
                    continue 'down;
                }
                while active != 0 {
                    let i = active.trailing_zeros() as usize & (RAYS - 1);
                    active &= active - 1;
                    self.walk_alone(simd, bvh, child, i, query, lone);
                }
                limit = self.last_limit(simd);
            }
        }
    }

    /// Tests a leaf against the rays in `active`.
    #[inline(always)]
    fn visit_leaf<const N: usize, L: Leaves<N>, S: Simd<N>, Q: Query<State = T>>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        first: usize,
        count: u32,
        active: u32,
        query: &mut Q,
    ) {
        let (mut changed, states, limit) = (0u32, &mut self.states, &mut self.limit);
        bvh.leaves.meet_sixteen(simd, first, count, &self.rays, active, |i, primitive, candidate| {
            let i = i & (RAYS - 1);
            changed |= 1 << i;
            // Unless it is answered.
            if limit[i] > f32::NEG_INFINITY && query.offer(&mut states[i], primitive, candidate) {
                limit[i] = f32::NEG_INFINITY;
            }
        });
        while changed != 0 {
            let i = changed.trailing_zeros() as usize & (RAYS - 1);
            changed &= changed - 1;
            if self.limit[i] > f32::NEG_INFINITY {
                self.limit[i] = Clock::of(&bvh.region).limit(Q::limit(&self.states[i]));
            }
        }
    }

    #[inline(always)]
    fn walk_alone<const N: usize, L: Leaves<N>, S: Simd<N>, Q: Query<State = T>>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        child: Packed,
        i: usize,
        query: &mut Q,
        stacks: &mut Stacks,
    ) {
        let Some(edges) = self.rays.one(i) else { return };
        let alone = Alone { lanes: &self.rays.blocks.of(i), edges: &edges, clock: Clock::of(&bvh.region) };
        let boxes = Boxes::of(self.slabs, self.first, i, self.limit[i], child, 0);
        let answered = alone.walk(simd, bvh, boxes, query, &mut self.states[i], stacks);
        self.limit[i] =
            if answered { f32::NEG_INFINITY } else { Clock::of(&bvh.region).limit(Q::limit(&self.states[i])) };
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
            let near = simd.sub(simd.load(&node.planes[axis][first]), simd.splat(self.bounds.near[axis]));
            let far = simd.sub(simd.load(&node.planes[axis][first ^ 1]), simd.splat(self.bounds.far[axis]));
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
            let mut nears = simd.load(&self.slabs.t_min.as_chunks::<N>().0[part]);
            let mut fars = simd.load(&self.limit.as_chunks::<N>().0[part]);
            for axis in 0..3 {
                let first = self.first[axis] & 1;
                let inverse = simd.load(&self.slabs.inverse[axis].as_chunks::<N>().0[part]);
                let near = simd.load(&self.slabs.near[axis].as_chunks::<N>().0[part]);
                let far = simd.load(&self.slabs.far[axis].as_chunks::<N>().0[part]);
                nears = simd.max(nears, simd.mul_add(simd.splat(node.planes[axis][first][lane]), inverse, near));
                fars = simd.min(fars, simd.mul_add(simd.splat(node.planes[axis][first ^ 1][lane]), inverse, far));
            }
            meeting |= simd.le(nears, fars) << (part * N);
        }
        meeting & ALL
    }
}

/// The nearest of the children in the lanes of `hit`, the first of which is `place`; the others go on to the stack, the
/// farther the deeper.
#[inline(always)]
fn nearest<const N: usize, S: Simd<N>>(
    simd: S,
    nears: S::F32,
    mut hit: u32,
    place: u32,
    stack: &mut [Entry],
    top: &mut usize,
) -> Option<u32> {
    if hit == 0 {
        return None;
    }
    let mut distances = [0f32; N];
    simd.store(nears, &mut distances);
    let lane = hit.trailing_zeros() as usize & (N - 1);
    hit &= hit - 1;
    let mut best = Entry { near: distances[lane], place: place + lane as u32 };
    let bottom = *top;
    while hit != 0 {
        let lane = hit.trailing_zeros() as usize & (N - 1);
        hit &= hit - 1;
        let mut entry = Entry { near: distances[lane], place: place + lane as u32 };
        if entry.near < best.near {
            std::mem::swap(&mut entry, &mut best);
        }
        let mut at = *top;
        while at > bottom && stack[at - 1].near < entry.near {
            stack[at] = stack[at - 1];
            at -= 1;
        }
        stack[at] = entry;
        *top += 1;
    }
    Some(best.place)
}

/// What is on top of the stack and still of interest.
#[inline(always)]
fn pop(stack: &[Entry], top: &mut usize, limit: f32) -> Option<u32> {
    while *top > 0 {
        *top -= 1;
        // What starts exactly at the limit may hold an equal t of a lower primitive.
        if stack[*top].near <= limit {
            return Some(stack[*top].place);
        }
    }
    None
}
