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
use super::bests::Bests;
use super::first::First;
use super::node::{Packed, WideNode};
use super::sixteen::Sixteen;
use super::step::Stacks;
use super::{single, winners};
use crate::accel::slab::Clock;
use crate::shapes::triangle::{ALL, Column, Leaves, Met, RAYS};
use crate::simd::{Lanes, Simd};

/// So many rays or fewer go on alone.
const FEW: u32 = 4;

/// Rays of one packet, all plain ([`Sixteen`]) and going the same way along every axis.
struct Packet<'a> {
    rays: &'a Sixteen,
    bests: Bests,
    /// Where in box units each loses interest; −∞ for rays that are answered or missing.
    limit: Column<f32>,
    bounds: Bounds,
    /// The plane that is met first, by axis; for all rays.
    first: [usize; 3],
    /// The first of them in the batch.
    start: usize,
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
pub fn answer<const N: usize, L: Leaves<N>, S: Simd<N>, A: Answer>(
    simd: S,
    bvh: &WideBvh<N, L>,
    errand: &mut First<'_, A>,
) {
    let batch = errand.rays;
    let mut stack = Stacks::new::<N>(1, bvh.stack);
    let mut lone = Stacks::new::<N>(1, bvh.stack);
    let mut rays = Sixteen::default();
    for start in (0..batch.len()).step_by(RAYS) {
        let count = RAYS.min(batch.len() - start);
        let mut first = None;
        if count as u32 > FEW {
            rays.take::<N, L, _>(simd.sixteen(), batch, start, &bvh.region);
            if rays.plain.plain == ALL {
                first = rays.slabs.first(simd.sixteen());
            }
        }
        let Some(first) = first else {
            for i in start..start + count {
                single::ask(simd, bvh, batch, i, errand, &mut lone);
            }
            continue;
        };
        let mut packet = Packet::new(simd.sixteen(), &rays, first, start, count);
        packet.walk(simd, bvh, errand, &mut stack, &mut lone);
        if A::ANY {
            errand.answer.some(start, count, packet.bests.answered, &Met::NONE, &[0; RAYS]);
        } else {
            winners::settle(bvh, batch, start, count, &packet.bests, errand.answer);
        }
    }
    errand.winners.settle(bvh, batch, errand.answer);
}

impl Bounds {
    #[inline(always)]
    fn of<S: Lanes<RAYS>>(simd: S, rays: &Sixteen, first: [usize; 3]) -> Self {
        let (slabs, pad) = (&rays.slabs, simd.load(&rays.slabs.pad));
        let t_min = simd.least(simd.load(&slabs.t_min));
        let mut bounds = Self { near: [0.0; 3], far: [0.0; 3], inverse: [[0.0; 2]; 3], t_min };
        for axis in 0..3 {
            let towards = if first[axis] == 0 { 1.0 } else { -1.0 };
            let origin = simd.mul(simd.load(&rays.plain.local[axis]), simd.splat(towards));
            let size = simd.abs(simd.load(&slabs.inverse[axis]));
            bounds.near[axis] = simd.greatest(simd.add(origin, pad)) * towards;
            bounds.far[axis] = simd.least(simd.sub(origin, pad)) * towards;
            bounds.inverse[axis] = [simd.least(size) * towards, simd.greatest(size) * towards];
        }
        bounds
    }
}

impl<'a> Packet<'a> {
    /// The first `count` of sixteen rays.
    #[inline(always)]
    fn new<S: Lanes<RAYS>>(simd: S, rays: &'a Sixteen, first: [usize; 3], start: usize, count: usize) -> Self {
        let (mut limit, none) = ([0.0; RAYS], simd.splat(f32::NEG_INFINITY));
        simd.store(simd.select(ALL >> (RAYS - count), simd.load(&rays.slabs.limit), none), &mut limit);
        Self { rays, bests: Bests::none(rays), limit, bounds: Bounds::of(simd, rays, first), first, start }
    }

    /// Where the last ray loses interest.
    #[inline(always)]
    fn last_limit<S: Lanes<RAYS>>(&self, simd: S) -> f32 {
        simd.greatest(simd.load(&self.limit))
    }

    /// Visits all that any ray may hit.
    #[inline(always)]
    fn walk<const N: usize, L: Leaves<N>, S: Simd<N>, A: Answer>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        errand: &mut First<'_, A>,
        stack: &mut Stacks,
        lone: &mut Stacks,
    ) {
        let octant = self.first[0] | self.first[1] << 1 | self.first[2] << 2;
        let mut limit = self.last_limit(simd.sixteen());
        let (bottom, mut index) = (1, 0);
        let mut top = bottom;
        'down: loop {
            let node = &bvh.nodes[index];
            let (nears, fars) = self.interval(simd, node, limit);
            // A child is known by its node and lane, so that its box is at hand when it is popped.
            let mut places = [(index * N) as u32; N];
            for (lane, place) in places.iter_mut().enumerate() {
                *place += lane as u32;
            }
            top += stack.push(simd, top, nears, fars, &places, node.order(octant));
            loop {
                if top == bottom {
                    return;
                }
                top -= 1;
                let (near, place) = stack.entry(top);
                // What starts exactly at the limit may hold an equal t of a lower primitive.
                if near > limit {
                    continue;
                }
                let (parent, lane) = (&bvh.nodes[place as usize / N], place as usize & (N - 1));
                let mut active = self.meeting(simd.sixteen(), parent, lane);
                let child = Packed::of(parent.children[lane]);
                if child.is_leaf() == 1 {
                    if active != 0 && self.visit_leaf::<N, L, S, A>(simd, bvh, child, active, errand) {
                        limit = self.last_limit(simd.sixteen());
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
                    self.walk_alone(simd, bvh, child, i, errand, lone);
                }
                limit = self.last_limit(simd.sixteen());
            }
        }
    }

    /// Tests a leaf against the rays in `active`: each triangle against all of them, or each of them against all
    /// triangles. Whether some have a new limit.
    #[inline(always)]
    fn visit_leaf<const N: usize, L: Leaves<N>, S: Simd<N>, A: Answer>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        leaf: Packed,
        active: u32,
        errand: &First<'_, A>,
    ) -> bool {
        let (_, count) = leaf.leaf();
        let mut changed = 0;
        if active.count_ones() <= count {
            let mut rest = active;
            while rest != 0 {
                let i = rest.trailing_zeros() as usize & (RAYS - 1);
                rest &= rest - 1;
                let mut ray = self.bests.looking(self.rays, i, self.start);
                let has_changed = if A::ANY {
                    ray.visit::<true, N, L, S>(simd, &bvh.leaves, &bvh.region, leaf, errand.rays)
                } else {
                    ray.visit::<false, N, L, S>(simd, &bvh.leaves, &bvh.region, leaf, errand.rays)
                };
                if !A::ANY {
                    // What has won may lie no nearer in f32.
                    self.bests.note(i, ray.best);
                }
                changed |= u32::from(has_changed) << i;
            }
        } else {
            let from = (errand.rays, self.start);
            for lane in 0..count {
                if A::ANY {
                    // What is answered is asked no more.
                    let asked = active & !changed;
                    changed |= self.bests.test::<true, N, L, _>(simd.sixteen(), bvh, self.rays, from, leaf, lane, asked);
                } else {
                    changed |=
                        self.bests.test::<false, N, L, _>(simd.sixteen(), bvh, self.rays, from, leaf, lane, active);
                }
            }
        }
        if changed != 0 {
            self.lose_interest::<N, L, _, A>(simd.sixteen(), bvh, changed);
        }
        changed != 0
    }

    /// Takes note of new limits of some rays.
    #[inline(always)]
    fn lose_interest<const N: usize, L: Leaves<N>, S: Lanes<RAYS>, A: Answer>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        changed: u32,
    ) {
        // A power of two, or too great for an f32, and then nothing is left out.
        let to_box = (bvh.region.scale / L::unit(&bvh.region)) as f32;
        let limit = if A::ANY {
            self.bests.answered |= changed;
            simd.splat(f32::NEG_INFINITY)
        } else if to_box <= f32::MAX {
            let least = simd.splat(f32::MIN_POSITIVE);
            simd.mul_add(simd.load(&self.bests.high), simd.splat(to_box), least)
        } else {
            simd.splat(f32::INFINITY)
        };
        simd.store(simd.select(changed, limit, simd.load(&self.limit)), &mut self.limit);
    }

    #[inline(always)]
    fn walk_alone<const N: usize, L: Leaves<N>, S: Simd<N>, A: Answer>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        child: Packed,
        i: usize,
        errand: &mut First<'_, A>,
        stacks: &mut Stacks,
    ) {
        let mut ray = self.bests.looking(self.rays, i, self.start);
        let boxes = self.rays.boxes(i, self.limit[i], child, 0);
        if single::walk(simd, bvh, boxes, errand, &mut ray, stacks) {
            self.bests.answered |= 1 << i;
            self.limit[i] = f32::NEG_INFINITY;
        } else if !A::ANY {
            self.bests.note(i, ray.best);
            self.limit[i] = Clock::of(&bvh.region).limit(f64::from(ray.best.high) / L::unit(&bvh.region));
        }
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
    fn meeting<const N: usize, S: Lanes<RAYS>>(&self, simd: S, node: &WideNode<N>, lane: usize) -> u32 {
        let slabs = &self.rays.slabs;
        let (mut nears, mut fars) = (simd.load(&slabs.t_min), simd.load(&self.limit));
        for axis in 0..3 {
            let first = self.first[axis] & 1;
            let inverse = simd.load(&slabs.inverse[axis]);
            let near = simd.splat(node.planes[axis][first][lane]);
            let far = simd.splat(node.planes[axis][first ^ 1][lane]);
            nears = simd.max(nears, simd.mul_add(near, inverse, simd.load(&slabs.near[axis])));
            fars = simd.min(fars, simd.mul_add(far, inverse, simd.load(&slabs.far[axis])));
        }
        simd.le(nears, fars)
    }
}
