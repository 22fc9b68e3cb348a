//! What rays do at a node: test its children, and put those that they meet on to a stack.

use super::node::{Packed, WideNode};
use crate::slab::{Clock, SlabRay, SlabRays};
use raywright_base::math::Region;
use raywright_base::simd::{ASCENDING, Simd};
use raywright_shapes::triangle::RAYS;
use std::cell::RefCell;

/// What a ray needs at nodes, a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Boxes {
    inverse: [f32; 3],
    near: [f32; 3],
    far: [f32; 3],
    t_min: f32,
    /// Where in box units the query loses interest.
    pub limit: f32,
    /// Where in a pair of planes that stands which is met first, by axis: 0, or 8 where the ray goes down. Then the
    /// octant that it goes towards, bit i for axis i.
    first: [u8; 4],
    /// Where its stack ends.
    top: u32,
    /// Where it is.
    pub at: Packed,
    /// How far along its origin was moved, in box units.
    start: f64,
}

const _: () = assert!(size_of::<Boxes>() == 64);

impl Boxes {
    /// No ray.
    pub const NOWHERE: Self = Self {
        inverse: [0.0; 3],
        near: [0.0; 3],
        far: [0.0; 3],
        t_min: 0.0,
        limit: 0.0,
        first: [0; 4],
        top: 0,
        at: Packed::NONE,
        start: 0.0,
    };

    /// At a child, with nothing on the stack that starts at `bottom`.
    #[inline(always)]
    pub fn new(slabs: &SlabRay, limit: f32, at: Packed, bottom: usize) -> Self {
        let SlabRay { inverse, near, far, t_min, .. } = *slabs;
        let (first, start) = (first(inverse), slabs.clock.start());
        Self { inverse, near, far, t_min, limit, first, top: bottom as u32 + 1, at, start }
    }

    /// One of sixteen, at a child, with nothing on the stack that starts at `bottom`.
    // To transpose all sixteen at once takes as long.
    #[inline(always)]
    pub fn of(slabs: &SlabRays, i: usize, limit: f32, at: Packed, bottom: usize) -> Self {
        let i = i & (RAYS - 1);
        let SlabRays { inverse, near, far, t_min, .. } = slabs;
        let inverse = [inverse[0][i], inverse[1][i], inverse[2][i]];
        Self {
            inverse,
            near: [near[0][i], near[1][i], near[2][i]],
            far: [far[0][i], far[1][i], far[2][i]],
            t_min: t_min[i],
            limit,
            first: first(inverse),
            top: bottom as u32 + 1,
            at,
            start: 0.0,
        }
    }

    /// From `t` along its scaled direction to box units.
    #[inline(always)]
    pub fn clock(&self, region: &Region) -> Clock {
        Clock::started(region, self.start)
    }

    /// Goes on to what is on top of the stack.
    #[inline(always)]
    pub fn pop(&mut self, stacks: &Stacks) {
        self.top -= 1;
        self.at = Packed::of(stacks.items[self.top as usize]);
    }

    /// Tests the children of the node where the ray is and puts those that it meets on to the stack, the nearest on top
    /// or, if not `NEAREST_FIRST`, what stands in the last lane. Where on the ray they are met is kept if `KEPT`, for
    /// [`Self::shorten`]. No branch depends on the ray.
    // Written out, axis by axis: closures between a kernel's entry and here are not always compiled for its level.
    #[inline(always)]
    pub fn enter<const N: usize, S: Simd<N>, const NEAREST_FIRST: bool, const KEPT: bool>(
        &mut self,
        simd: S,
        node: &WideNode<N>,
        stacks: &mut Stacks,
    ) {
        let [x, y, z, octant] = self.first;
        let planes = [pair(&node.planes[0]), pair(&node.planes[1]), pair(&node.planes[2])];
        let inverse = [simd.splat(self.inverse[0]), simd.splat(self.inverse[1]), simd.splat(self.inverse[2])];
        let near_x = simd.mul_add(simd.load(plane(planes[0], x)), inverse[0], simd.splat(self.near[0]));
        let near_y = simd.mul_add(simd.load(plane(planes[1], y)), inverse[1], simd.splat(self.near[1]));
        let near_z = simd.mul_add(simd.load(plane(planes[2], z)), inverse[2], simd.splat(self.near[2]));
        let far_x = simd.mul_add(simd.load(plane(planes[0], x ^ 8)), inverse[0], simd.splat(self.far[0]));
        let far_y = simd.mul_add(simd.load(plane(planes[1], y ^ 8)), inverse[1], simd.splat(self.far[1]));
        let far_z = simd.mul_add(simd.load(plane(planes[2], z ^ 8)), inverse[2], simd.splat(self.far[2]));
        let nears = simd.max(simd.max(near_x, near_y), simd.max(near_z, simd.splat(self.t_min)));
        let fars = simd.min(simd.min(far_x, far_y), simd.min(far_z, simd.splat(self.limit)));
        let order = if NEAREST_FIRST { node.order(octant.into()) } else { ASCENDING };
        let top = self.top as usize;
        self.top += stacks.push::<KEPT, N, S>(simd, top, nears, fars, &node.children, order) as u32;
    }

    /// Takes note of a new limit: rids the stack, which starts at `bottom`, of what starts beyond. What starts exactly
    /// there may hold an equal `t` of a lower primitive.
    #[inline(always)]
    pub fn shorten<const N: usize, S: Simd<N>>(&mut self, simd: S, limit: f32, stacks: &mut Stacks, bottom: usize) {
        self.limit = limit;
        let limit = simd.splat(limit);
        // The lowest entry always stays.
        let (mut kept, end) = (bottom + 1, self.top as usize);
        for from in (bottom + 1..end).step_by(N) {
            // Read whole before the same places are written.
            let nears = simd.load(room::<N, _>(&mut stacks.nears, from));
            let items = *room::<N, _>(&mut stacks.items, from);
            let count = (end - from).min(N) as u32;
            let (to_nears, to_items) = (room::<N, _>(&mut stacks.nears, kept), room::<N, _>(&mut stacks.items, kept));
            kept += simd.pick(nears, limit, &items, ASCENDING, count, to_nears, to_items);
        }
        self.top = kept as u32;
    }
}

/// [`Boxes::first`] of a ray.
#[inline(always)]
fn first(inverse: [f32; 3]) -> [u8; 4] {
    let [x, y, z] = [u8::from(inverse[0] < 0.0), u8::from(inverse[1] < 0.0), u8::from(inverse[2] < 0.0)];
    [8 * x, 8 * y, 8 * z, x | y << 1 | z << 2]
}

/// The planes of both sides along an axis, one after the other.
#[inline(always)]
fn pair<const N: usize>(planes: &[[f32; N]; 2]) -> &[f32] {
    planes.as_flattened()
}

/// One of them; the place is in eighths of a plane, so that it is an address as it stands where planes are of eight.
#[inline(always)]
fn plane<const N: usize>(planes: &[f32], place: u8) -> &[f32; N] {
    planes[(usize::from(place) & 8) * N / 8..].first_chunk().expect("one of two")
}

thread_local! {
    /// Stacks for one ray each that nobody uses. There are as many as accelerators are asked one within the other.
    static SPARE: RefCell<Vec<Stacks>> = const { RefCell::new(Vec::new()) };
}

/// What rays have still to visit, and from where on: a stack for each, of which the lowest entry says that there is
/// nothing more.
pub struct Stacks {
    nears: Vec<f32>,
    items: Vec<u32>,
    depth: usize,
}

impl Stacks {
    /// For so many rays in a tree of which a walk leaves at most `entries` behind.
    pub fn new<const N: usize>(rays: usize, entries: usize) -> Self {
        // Room for a move of all lanes behind the last.
        let depth = entries + 1 + N;
        assert!(depth * rays <= u32::MAX as usize, "stacks of fewer than 2^32 entries");
        Self { nears: vec![0.0; depth * rays], items: vec![Packed::NONE.bits(); depth * rays], depth }
    }

    /// Of no ray.
    pub const NONE: Self = Self { nears: Vec::new(), items: Vec::new(), depth: 0 };

    /// One of those that this thread has put away, or a new one, for one ray: to make them anew takes as long as some
    /// nodes.
    pub fn spare<const N: usize>(entries: usize) -> Self {
        let fits = |stacks: &Self| stacks.depth > entries + N;
        SPARE.with_borrow_mut(Vec::pop).filter(fits).unwrap_or_else(|| Self::new::<N>(1, entries))
    }

    /// Keeps it for the thread's next ray. What is in it means nothing to that, but for the lowest entry, which nothing
    /// changes.
    pub fn put_away(self) {
        SPARE.with_borrow_mut(|spare| spare.push(self));
    }

    /// Puts those of a node's children on top, which is `top`, for which `nears ≤ fars`, the last in `order` the
    /// highest; says how many they are. Unless `KEPT`, `nears` are forgotten.
    #[inline(always)]
    pub fn push<const KEPT: bool, const N: usize, S: Simd<N>>(
        &mut self,
        simd: S,
        top: usize,
        nears: S::F32,
        fars: S::F32,
        items: &[u32; N],
        order: u32,
    ) -> usize {
        let mut nowhere = [0.0; N];
        let to_nears = if KEPT { room(&mut self.nears, top) } else { &mut nowhere };
        let to_items = room(&mut self.items, top);
        simd.pick(nears, fars, items, order, N as u32, to_nears, to_items)
    }

    /// What was put at a place, and from where on it is met.
    #[inline(always)]
    pub fn entry(&self, at: usize) -> (f32, u32) {
        (self.nears[at], self.items[at])
    }

    /// Where the stack of one of them starts.
    #[inline(always)]
    pub fn bottom(&self, ray: usize) -> usize {
        ray * self.depth
    }
}

/// Room for a move of all lanes from a place on.
#[inline(always)]
fn room<const N: usize, T>(stack: &mut [T], from: usize) -> &mut [T; N] {
    (&mut stack[from..from + N]).try_into().expect("stacks end with room for one move more")
}
