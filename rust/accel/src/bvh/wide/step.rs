//! The traversal step at a node: test its children, and push those that are hit.

use super::node::{Packed, WideNode};
use crate::slab::{Clock, SlabRay, SlabRays};
use raywright_base::math::Region;
use raywright_base::simd::{ASCENDING, Simd};
use raywright_shapes::triangle::RAYS;
use std::cell::RefCell;

/// The data of a ray at nodes, one cache line.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Boxes {
    inverse: [f32; 3],
    near: [f32; 3],
    far: [f32; 3],
    t_min: f32,
    /// The end of the ray in box units.
    pub limit: f32,
    /// The offset of the near plane in a pair of planes, by axis: 0, or 8 if the direction is negative. Then the ray's
    /// octant, bit i for axis i.
    first: [u8; 4],
    /// The end of its stack.
    top: u32,
    /// The current child.
    pub at: Packed,
    /// The distance by which its origin was moved, in box units.
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

    /// A ray at a child, with an empty stack that starts at `bottom`.
    #[inline(always)]
    pub fn new(slabs: &SlabRay, limit: f32, at: Packed, bottom: usize) -> Self {
        let SlabRay { inverse, near, far, t_min, .. } = *slabs;
        let (first, start) = (first(inverse), slabs.clock.start());
        Self { inverse, near, far, t_min, limit, first, top: bottom as u32 + 1, at, start }
    }

    /// One of sixteen rays, at a child, with an empty stack that starts at `bottom`.
    // Transposing all sixteen at once takes as long.
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

    /// The conversion of `t` along its scaled direction to box units.
    #[inline(always)]
    pub fn clock(&self, region: &Region) -> Clock {
        Clock::started(region, self.start)
    }

    /// Pop the stack.
    #[inline(always)]
    pub fn pop(&mut self, stacks: &Stacks) {
        self.top -= 1;
        self.at = Packed::of(stacks.items[self.top as usize]);
    }

    /// Test the children of the current node and push those that the ray hits. The nearest is on top or, unless
    /// `NEAREST_FIRST`, the one in the last lane. Their distances are kept if `KEPT`, for [`Self::shorten`]. No branch
    /// depends on the ray.
    // Written out axis by axis: closures between a kernel's entry and here are not always compiled for its SIMD level.
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

    /// Set a new limit: remove the entries beyond it from the stack, which starts at `bottom`. An entry that starts
    /// exactly there may contain a lower primitive at equal `t`.
    #[inline(always)]
    pub fn shorten<const N: usize, S: Simd<N>>(&mut self, simd: S, limit: f32, stacks: &mut Stacks, bottom: usize) {
        self.limit = limit;
        let limit = simd.splat(limit);
        // The lowest entry always stays.
        let (mut kept, end) = (bottom + 1, self.top as usize);
        for from in (bottom + 1..end).step_by(N) {
            // All lanes are read before the same places are written.
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

/// One plane of a pair. The offset is in eighths of a plane, so that for planes of eight it is an index as it is.
#[inline(always)]
fn plane<const N: usize>(planes: &[f32], place: u8) -> &[f32; N] {
    planes[(usize::from(place) & 8) * N / 8..].first_chunk().expect("one of two")
}

thread_local! {
    /// A pool of single-ray stacks. It grows to the maximum nesting of accelerators.
    static SPARE: RefCell<Vec<Stacks>> = const { RefCell::new(Vec::new()) };
}

/// Stacks of children to visit and their distances, one stack per ray. The lowest entry of each marks the end.
pub struct Stacks {
    nears: Vec<f32>,
    items: Vec<u32>,
    depth: usize,
}

impl Stacks {
    /// Create stacks for a number of rays, in a tree whose traversal leaves at most `entries` pending.
    pub fn new<const N: usize>(rays: usize, entries: usize) -> Self {
        // Padding for a vector store after the last entry.
        let depth = entries + 1 + N;
        assert!(depth * rays <= u32::MAX as usize, "stacks of fewer than 2^32 entries");
        Self { nears: vec![0.0; depth * rays], items: vec![Packed::NONE.bits(); depth * rays], depth }
    }

    /// Stacks for no rays.
    pub const NONE: Self = Self { nears: Vec::new(), items: Vec::new(), depth: 0 };

    /// Take a stack for one ray from this thread's pool, or create one. Creating one takes as long as some nodes.
    pub fn spare<const N: usize>(entries: usize) -> Self {
        let fits = |stacks: &Self| stacks.depth > entries + N;
        SPARE.with_borrow_mut(Vec::pop).filter(fits).unwrap_or_else(|| Self::new::<N>(1, entries))
    }

    /// Return it to the thread's pool. Its content is irrelevant except the lowest entry, which never changes.
    pub fn put_away(self) {
        SPARE.with_borrow_mut(|spare| spare.push(self));
    }

    /// Push the children with `nears ≤ fars` at index `top`, the last in `order` on top; return their number. Unless
    /// `KEPT`, `nears` are discarded.
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

    /// The distance and child of an entry.
    #[inline(always)]
    pub fn entry(&self, at: usize) -> (f32, u32) {
        (self.nears[at], self.items[at])
    }

    /// The start of a ray's stack.
    #[inline(always)]
    pub fn bottom(&self, ray: usize) -> usize {
        ray * self.depth
    }
}

/// The N entries from an index, for a vector store.
#[inline(always)]
fn room<const N: usize, T>(stack: &mut [T], from: usize) -> &mut [T; N] {
    (&mut stack[from..from + N]).try_into().expect("stacks end with room for one move more")
}
