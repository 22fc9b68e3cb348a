//! One ray at a time through a wide tree: nearest child first, the others on a stack with their distances.

use super::node::Packed;
use super::{Kernel, WideBvh};
use crate::accel::SlabRay;
use crate::math::{Hit, Ray};
use crate::shapes::triangle::{BlockRay, EdgeRay, TriangleBlock};
use crate::simd::Simd;

/// A batch of rays for one tree, answered into `out`.
pub struct Batch<'a, const N: usize, Q> {
    pub bvh: &'a WideBvh<N>,
    pub rays: &'a [Ray],
    pub out: Q,
}

/// A ray as blocks of triangles see it.
#[derive(Clone, Copy)]
pub struct LeafRay<'a, const N: usize, S: Simd<N>> {
    lanes: &'a BlockRay<N, S>,
    edges: &'a EdgeRay,
}

/// What is asked of each ray: a type, so that each question has a loop of its own.
pub trait Query<const N: usize> {
    /// What is known of a ray so far.
    type State: Copy;

    /// Nothing is known yet.
    fn start(ray: &EdgeRay) -> Self::State;
    /// The greatest `t` that still matters.
    fn limit(state: &Self::State) -> f64;
    /// Tests a block; true if the question is answered.
    fn test<S: Simd<N>>(
        simd: S,
        block: &TriangleBlock<N>,
        count: u32,
        ray: LeafRay<N, S>,
        state: &mut Self::State,
    ) -> bool;
    /// Writes down the answer for ray `i`; without a state, that of a ray that hits nothing.
    fn finish(&mut self, i: usize, answer: Option<(&EdgeRay, Self::State)>);
}

/// The closest hit.
pub struct Closest<'a>(pub &'a mut [Hit]);

impl<const N: usize> Query<N> for Closest<'_> {
    type State = Hit;

    #[inline(always)]
    fn start(ray: &EdgeRay) -> Hit {
        // Beyond t_max nothing is accepted, so that a hit at t_max itself still beats this.
        Hit { t: ray.t_max.next_up(), ..Hit::MISS }
    }
    #[inline(always)]
    fn limit(state: &Hit) -> f64 {
        state.t
    }
    #[inline(always)]
    fn test<S: Simd<N>>(simd: S, block: &TriangleBlock<N>, count: u32, ray: LeafRay<N, S>, state: &mut Hit) -> bool {
        block.closest(simd, ray.lanes, ray.edges, count, state);
        false
    }
    #[inline(always)]
    fn finish(&mut self, i: usize, answer: Option<(&EdgeRay, Hit)>) {
        self.0[i] = match answer {
            Some((ray, hit)) if hit.is_hit() => Hit { t: hit.t * ray.scale, ..hit },
            _ => Hit::MISS,
        };
    }
}

/// Whether there is any hit.
pub struct Any<'a>(pub &'a mut [bool]);

impl<const N: usize> Query<N> for Any<'_> {
    type State = (bool, f64);

    #[inline(always)]
    fn start(ray: &EdgeRay) -> (bool, f64) {
        (false, ray.t_max)
    }
    #[inline(always)]
    fn limit(state: &(bool, f64)) -> f64 {
        state.1
    }
    #[inline(always)]
    fn test<S: Simd<N>>(
        simd: S,
        block: &TriangleBlock<N>,
        count: u32,
        ray: LeafRay<N, S>,
        state: &mut (bool, f64),
    ) -> bool {
        state.0 = block.any(simd, ray.lanes, ray.edges, count);
        state.0
    }
    #[inline(always)]
    fn finish(&mut self, i: usize, answer: Option<(&EdgeRay, (bool, f64))>) {
        self.0[i] = answer.is_some_and(|(_, (hit, _))| hit);
    }
}

#[derive(Clone, Copy)]
struct Entry {
    near: f32,
    child: Packed,
}

impl<const N: usize, Q: Query<N>> Kernel<N> for Batch<'_, N, Q> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd<N>>(mut self, simd: S) {
        let mut stack = vec![Entry { near: 0.0, child: Packed::ROOT }; self.bvh.stack];
        for (i, ray) in self.rays.iter().enumerate() {
            let ready = if self.bvh.nodes.is_empty() {
                None
            } else {
                SlabRay::prepare(ray, self.bvh.extent, self.bvh.box_scale)
            };
            match ready {
                Some((edges, slabs)) => {
                    let state = walk::<N, S, Q>(simd, self.bvh, &edges, &slabs, &mut stack);
                    self.out.finish(i, Some((&edges, state)));
                }
                None => self.out.finish(i, None),
            }
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
    let mut state = Q::start(edges);
    let mut limit = slabs.limit(Q::limit(&state));
    // Written out, not in closures: those are not always compiled for the kernel's level.
    let inverse = [simd.splat(slabs.inverse[0]), simd.splat(slabs.inverse[1]), simd.splat(slabs.inverse[2])];
    let near = [simd.splat(slabs.near[0]), simd.splat(slabs.near[1]), simd.splat(slabs.near[2])];
    let far = [simd.splat(slabs.far[0]), simd.splat(slabs.far[1]), simd.splat(slabs.far[2])];
    let t_min = simd.splat(slabs.t_min);
    let first = slabs.first;
    let lanes = BlockRay::new(simd, edges);

    let mut top = 0;
    let mut child = Packed::ROOT;
    loop {
        if let Some(index) = child.node() {
            let node = &bvh.nodes[index];
            let planes = &node.bounds;
            let near_x = simd.mul_add(simd.load(&planes[0][first[0]]), inverse[0], near[0]);
            let near_y = simd.mul_add(simd.load(&planes[1][first[1]]), inverse[1], near[1]);
            let near_z = simd.mul_add(simd.load(&planes[2][first[2]]), inverse[2], near[2]);
            let far_x = simd.mul_add(simd.load(&planes[0][1 - first[0]]), inverse[0], far[0]);
            let far_y = simd.mul_add(simd.load(&planes[1][1 - first[1]]), inverse[1], far[1]);
            let far_z = simd.mul_add(simd.load(&planes[2][1 - first[2]]), inverse[2], far[2]);
            let nears = simd.max(simd.max(near_x, near_y), simd.max(near_z, t_min));
            let fars = simd.min(simd.min(far_x, far_y), simd.min(far_z, simd.splat(limit)));
            let mut hit = simd.le(nears, fars);
            if hit != 0 {
                let lane = hit.trailing_zeros() as usize & (N - 1);
                hit &= hit - 1;
                if hit == 0 {
                    child = node.packed(lane);
                    continue;
                }
                let mut distances = [0f32; N];
                simd.store(nears, &mut distances);
                // The nearest stays in hand; every other goes on to the stack, the farther the deeper.
                let mut best = Entry { near: distances[lane], child: node.packed(lane) };
                let bottom = top;
                while hit != 0 {
                    let lane = hit.trailing_zeros() as usize & (N - 1);
                    hit &= hit - 1;
                    let mut entry = Entry { near: distances[lane], child: node.packed(lane) };
                    if entry.near < best.near {
                        std::mem::swap(&mut entry, &mut best);
                    }
                    let mut place = top;
                    while place > bottom && stack[place - 1].near < entry.near {
                        stack[place] = stack[place - 1];
                        place -= 1;
                    }
                    stack[place] = entry;
                    top += 1;
                }
                child = best.child;
                continue;
            }
        } else {
            let (index, count) = child.block();
            if Q::test(simd, &bvh.blocks[index], count, LeafRay { lanes: &lanes, edges }, &mut state) {
                return state;
            }
            limit = slabs.limit(Q::limit(&state));
        }
        loop {
            if top == 0 {
                return state;
            }
            top -= 1;
            // What starts exactly at the limit may hold an equal t of a lower primitive.
            if stack[top].near <= limit {
                child = stack[top].child;
                break;
            }
        }
    }
}
