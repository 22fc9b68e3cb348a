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
use super::answer::Answer;
use super::best::{Best, between, meet};
use super::errand::Errand;
use super::first::{First, Looking};
use super::node::{Packed, WideNode};
use super::single;
use super::step::{Boxes, Stacks};
use crate::accel::slab::{Clock, SlabRays};
use crate::math::robust::{greater, lesser};
use crate::shapes::triangle::{ALL, BlockRays, Column, EdgeRays, Leaves, RAYS};
use crate::simd::Simd;

/// So many rays or fewer go on alone.
const FEW: u32 = 4;

/// Rays of one packet, all plain ([`EdgeRays::prepare`]) and going the same way along every axis.
struct Packet<'a> {
    edges: &'a EdgeRays,
    blocks: &'a BlockRays,
    slabs: &'a SlabRays,
    /// The best that is known of each; see [`Best`].
    low: Column<f32>,
    high: Column<f32>,
    leaf: Column<Packed>,
    lane: Column<u32>,
    /// Between these lies the `t_min` of each.
    t_min: [Column<f32>; 2],
    /// Where in box units each loses interest; −∞ for rays that are answered or missing.
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
pub fn answer<const N: usize, L: Leaves<N>, S: Simd<N>, A: Answer>(
    simd: S,
    bvh: &WideBvh<N, L>,
    errand: &mut First<'_, A>,
) {
    let rays = errand.rays;
    let mut stack = vec![Entry { near: 0.0, place: 0 }; bvh.stack];
    let mut lone = Stacks::new::<N>(1, bvh.stack);
    // The next packet's columns are written before this one is walked: a wide load must wait for narrow stores.
    let mut edges = [EdgeRays::default(), EdgeRays::default()];
    let mut slabs = SlabRays::default();
    edges[0].take(rays, 0);
    for (turn, start) in (0..rays.len()).step_by(RAYS).enumerate() {
        let count = RAYS.min(rays.len() - start);
        if start + RAYS < rays.len() {
            edges[(turn + 1) & 1].take(rays, start + RAYS);
        }
        let edges = &mut edges[turn & 1];
        let mut first = None;
        if count as u32 > FEW && edges.prepare(&bvh.region) == ALL {
            slabs.prepare(edges, &bvh.region);
            first = slabs.first();
        }
        let Some(first) = first else {
            for i in start..start + count {
                single::ask(simd, bvh, rays, i, errand, &mut lone);
            }
            continue;
        };
        let blocks = L::rays(edges, &bvh.region);
        let mut packet = Packet::new(simd, bvh, edges, &blocks, &slabs, first, count);
        packet.walk(simd, bvh, start, errand, &mut stack, &mut lone);
        packet.finish(bvh, start, count, errand);
    }
    errand.end(bvh);
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

impl<'a> Packet<'a> {
    /// The first `count` of sixteen rays.
    #[inline(always)]
    fn new<const N: usize, L: Leaves<N>, S: Simd<N>>(
        simd: S,
        bvh: &WideBvh<N, L>,
        edges: &'a EdgeRays,
        blocks: &'a BlockRays,
        slabs: &'a SlabRays,
        first: [usize; 3],
        count: usize,
    ) -> Self {
        let (unit, clock) = (L::unit(&bvh.region), Clock::of(&bvh.region));
        let mut packet = Self {
            edges,
            blocks,
            slabs,
            low: [0.0; RAYS],
            high: [0.0; RAYS],
            leaf: [Packed::NONE; RAYS],
            lane: [0; RAYS],
            t_min: [[0.0; RAYS]; 2],
            limit: [f32::NEG_INFINITY; RAYS],
            bounds: Bounds::of(simd, slabs, first),
            first,
        };
        for i in 0..RAYS {
            (packet.t_min[0][i], packet.t_min[1][i]) = between(edges.t_min[i] * unit);
            (packet.low[i], packet.high[i]) = between(edges.t_max[i] * unit);
            let limit = clock.limit(edges.t_max[i]);
            packet.limit[i] = if i < count { limit } else { f32::NEG_INFINITY };
        }
        packet
    }

    /// The first `count` have seen all that they have to; the first of them is `start` of the batch.
    #[inline(always)]
    fn finish<const N: usize, L: Leaves<N>, A: Answer>(
        &self,
        bvh: &WideBvh<N, L>,
        start: usize,
        count: usize,
        errand: &mut First<'_, A>,
    ) {
        for i in 0..count {
            errand.conclude(bvh, start + i, &self.best(i));
        }
    }

    /// Where the last ray loses interest.
    #[inline(always)]
    fn last_limit<const N: usize, S: Simd<N>>(&self, simd: S) -> f32 {
        greatest(simd, &self.limit)
    }

    /// Visits all that any ray may hit.
    #[inline(always)]
    fn walk<const N: usize, L: Leaves<N>, S: Simd<N>, A: Answer>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        start: usize,
        errand: &mut First<'_, A>,
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
                        self.visit_leaf::<N, L, S, A>(simd, bvh, child, active, start, errand);
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
                    self.walk_alone(simd, bvh, child, i, start, errand, lone);
                }
                limit = self.last_limit(simd);
            }
        }
    }

    /// Tests a leaf against the rays in `active`: each triangle against all of them, or each of them against all
    /// triangles.
    #[inline(always)]
    fn visit_leaf<const N: usize, L: Leaves<N>, S: Simd<N>, A: Answer>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        leaf: Packed,
        active: u32,
        start: usize,
        errand: &First<'_, A>,
    ) {
        let (first, count) = leaf.leaf();
        let mut changed = 0;
        if active.count_ones() <= count {
            let mut rest = active;
            while rest != 0 {
                let i = rest.trailing_zeros() as usize & (RAYS - 1);
                rest &= rest - 1;
                let mut ray = self.looking(i, start);
                let has_changed = if A::ANY {
                    ray.visit::<true, N, L, S>(simd, &bvh.leaves, &bvh.region, leaf, errand.rays)
                } else {
                    ray.visit::<false, N, L, S>(simd, &bvh.leaves, &bvh.region, leaf, errand.rays)
                };
                // What has won may lie no nearer in f32.
                self.note(i, if A::ANY && has_changed { Best { leaf, ..ray.best } } else { ray.best });
                changed |= u32::from(has_changed) << i;
            }
        } else {
            for lane in 0..count {
                let triangle = bvh.leaves.splat(simd, first, count, lane as usize);
                for part in 0..RAYS / N {
                    // What is answered is asked no more.
                    let asked = if A::ANY { active & !changed } else { active };
                    changed |= self.visit_triangle::<N, L, S, A>(simd, bvh, leaf, lane, triangle, part, asked);
                }
            }
        }
        self.lose_interest::<N, L, S, A>(simd, bvh, changed);
    }

    /// Takes note of new limits of some rays.
    #[inline(always)]
    fn lose_interest<const N: usize, L: Leaves<N>, S: Simd<N>, A: Answer>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        changed: u32,
    ) {
        // A power of two, or too great for an f32, and then nothing is left out.
        let to_box = (bvh.region.scale / L::unit(&bvh.region)) as f32;
        for part in 0..RAYS / N {
            let limit = if A::ANY {
                simd.splat(f32::NEG_INFINITY)
            } else if to_box <= f32::MAX {
                let least = simd.splat(f32::MIN_POSITIVE);
                simd.mul_add(part_of(simd, &self.high, part), simd.splat(to_box), least)
            } else {
                simd.splat(f32::INFINITY)
            };
            let limit = simd.select(changed >> (part * N), limit, part_of(simd, &self.limit, part));
            simd.store(limit, &mut self.limit.as_chunks_mut::<N>().0[part]);
        }
    }

    /// Tests a triangle against those of the rays in `active` that are in one vector; says of which what is known has
    /// changed, or, if any hit will do, which are answered.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn visit_triangle<const N: usize, L: Leaves<N>, S: Simd<N>, A: Answer>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        leaf: Packed,
        lane: u32,
        triangle: [[S::F32; 3]; 3],
        part: usize,
        active: u32,
    ) -> u32 {
        let active = active >> (part * N) & ((1 << N) - 1);
        if active == 0 {
            return 0;
        }
        let bracket = bvh.leaves.rays_bracket(simd, self.blocks, part, triangle);
        let [low, high] = [part_of(simd, &self.low, part), part_of(simd, &self.high, part)];
        let [from, after] = [part_of(simd, &self.t_min[0], part), part_of(simd, &self.t_min[1], part)];
        let beyond = simd.gt(bracket.low, high) | simd.gt(from, bracket.high);
        let mut open = active & bracket.possible & !(bracket.known & beyond);
        if open == 0 {
            return 0;
        }
        let sure = bracket.known & bracket.inside & simd.gt(bracket.low, after) & simd.gt(low, bracket.high);
        let mut sure = open & sure;
        open &= !sure;
        let mut changed = sure << (part * N);
        // By vectors, since the next triangle reads them so.
        simd.store(simd.select(sure, bracket.low, low), &mut self.low.as_chunks_mut::<N>().0[part]);
        simd.store(simd.select(sure, bracket.high, high), &mut self.high.as_chunks_mut::<N>().0[part]);
        while sure != 0 {
            let i = (part * N + sure.trailing_zeros() as usize) & (RAYS - 1);
            sure &= sure - 1;
            (self.leaf[i], self.lane[i]) = (leaf, lane);
        }
        while open != 0 {
            let i = part * N + open.trailing_zeros() as usize;
            open &= open - 1;
            if self.decide::<N, L, A>(bvh, i, leaf, lane) {
                changed |= 1 << i;
            }
        }
        changed
    }

    /// Decides about a ray and a triangle in f64.
    #[inline(never)]
    fn decide<const N: usize, L: Leaves<N>, A: Answer>(
        &mut self,
        bvh: &WideBvh<N, L>,
        i: usize,
        leaf: Packed,
        lane: u32,
    ) -> bool {
        let mut best = self.best(i);
        if A::ANY {
            let is_met = meet(&bvh.leaves, &self.edges.one(i), leaf, lane).is_some();
            if is_met {
                self.note(i, Best { leaf, lane, ..best });
            }
            return is_met;
        }
        if best.is(&bvh.leaves, leaf, lane) {
            return false;
        }
        let before = best.high;
        best.decide(&bvh.leaves, L::unit(&bvh.region), &self.edges.one(i), leaf, lane);
        self.note(i, best);
        best.high < before
    }

    /// The best that is known of a ray.
    #[inline(always)]
    fn best(&self, i: usize) -> Best {
        let i = i & (RAYS - 1);
        Best { low: self.low[i], high: self.high[i], leaf: self.leaf[i], lane: self.lane[i] }
    }

    #[inline(always)]
    fn note(&mut self, i: usize, best: Best) {
        let i = i & (RAYS - 1);
        (self.low[i], self.high[i], self.leaf[i], self.lane[i]) = (best.low, best.high, best.leaf, best.lane);
    }

    /// One of the rays, the first of which is `start` of the batch.
    #[inline(always)]
    fn looking(&self, i: usize, start: usize) -> Looking {
        Looking {
            lanes: self.blocks.of(i),
            t_min: (self.t_min[0][i & (RAYS - 1)], self.t_min[1][i & (RAYS - 1)]),
            best: self.best(i),
            t_max: self.edges.t_max[i & (RAYS - 1)],
            ray: start + i,
        }
    }

    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn walk_alone<const N: usize, L: Leaves<N>, S: Simd<N>, A: Answer>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        child: Packed,
        i: usize,
        start: usize,
        errand: &mut First<'_, A>,
        stacks: &mut Stacks,
    ) {
        let mut ray = self.looking(i, start);
        let boxes = Boxes::of(self.slabs, i, self.limit[i], child, 0);
        let is_answered = single::walk(simd, bvh, boxes, errand, &mut ray, stacks);
        self.note(i, ray.best);
        let limit = Clock::of(&bvh.region).limit(f64::from(ray.best.high) / L::unit(&bvh.region));
        self.limit[i] = if is_answered { f32::NEG_INFINITY } else { limit };
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

/// One vector of a column.
#[inline(always)]
fn part_of<const N: usize, S: Simd<N>>(simd: S, column: &Column<f32>, part: usize) -> S::F32 {
    simd.load(&column.as_chunks::<N>().0[part])
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
