//! What every kernel does at a node: test its children, go on to the nearest, remember the others.

use super::node::{Packed, WideNode};
use crate::accel::SlabRay;
use crate::simd::Simd;

/// What is still to be visited, and from where on.
#[derive(Clone, Copy)]
pub struct Entry<T = Packed> {
    near: f32,
    what: T,
}

impl<T> Entry<T> {
    /// Something that is met from `near` on; also what fills unused stacks.
    pub const fn new(near: f32, what: T) -> Self {
        Self { near, what }
    }
}

/// A ray's slabs in every lane.
#[derive(Clone, Copy)]
pub struct SlabLanes<const N: usize, S: Simd<N>> {
    inverse: [S::F32; 3],
    near: [S::F32; 3],
    far: [S::F32; 3],
    t_min: S::F32,
    first: [usize; 3],
}

// Written out, not in closures: those are not always compiled for the kernel's level.
impl<const N: usize, S: Simd<N>> SlabLanes<N, S> {
    /// Spreads a ray over the lanes.
    #[inline(always)]
    pub fn new(simd: S, slabs: &SlabRay) -> Self {
        let SlabRay { inverse, near, far, .. } = slabs;
        Self {
            inverse: [simd.splat(inverse[0]), simd.splat(inverse[1]), simd.splat(inverse[2])],
            near: [simd.splat(near[0]), simd.splat(near[1]), simd.splat(near[2])],
            far: [simd.splat(far[0]), simd.splat(far[1]), simd.splat(far[2])],
            t_min: simd.splat(slabs.t_min),
            first: slabs.first,
        }
    }

    /// The nearest child of a node that the ray meets before `limit`; the others go on to the stack, the farther the deeper.
    #[inline(always)]
    pub fn descend(
        &self,
        simd: S,
        node: &WideNode<N>,
        limit: f32,
        stack: &mut [Entry],
        top: &mut usize,
    ) -> Option<Packed> {
        let ([x, y, z], planes) = (self.first, &node.bounds);
        let near_x = simd.mul_add(simd.load(&planes[0][x]), self.inverse[0], self.near[0]);
        let near_y = simd.mul_add(simd.load(&planes[1][y]), self.inverse[1], self.near[1]);
        let near_z = simd.mul_add(simd.load(&planes[2][z]), self.inverse[2], self.near[2]);
        let far_x = simd.mul_add(simd.load(&planes[0][1 - x]), self.inverse[0], self.far[0]);
        let far_y = simd.mul_add(simd.load(&planes[1][1 - y]), self.inverse[1], self.far[1]);
        let far_z = simd.mul_add(simd.load(&planes[2][1 - z]), self.inverse[2], self.far[2]);
        let nears = simd.max(simd.max(near_x, near_y), simd.max(near_z, self.t_min));
        let fars = simd.min(simd.min(far_x, far_y), simd.min(far_z, simd.splat(limit)));
        nearest(simd, nears, simd.le(nears, fars), |lane| node.packed(lane), stack, top)
    }
}

/// The nearest of the children in the lanes of `hit`; the others go on to the stack, the farther the deeper.
#[inline(always)]
pub fn nearest<const N: usize, S: Simd<N>, T: Copy>(
    simd: S,
    nears: S::F32,
    mut hit: u32,
    child: impl Fn(usize) -> T,
    stack: &mut [Entry<T>],
    top: &mut usize,
) -> Option<T> {
    if hit == 0 {
        return None;
    }
    let lane = hit.trailing_zeros() as usize & (N - 1);
    hit &= hit - 1;
    if hit == 0 {
        return Some(child(lane));
    }
    let mut distances = [0f32; N];
    simd.store(nears, &mut distances);
    let mut best = Entry::new(distances[lane], child(lane));
    let bottom = *top;
    while hit != 0 {
        let lane = hit.trailing_zeros() as usize & (N - 1);
        hit &= hit - 1;
        let mut entry = Entry::new(distances[lane], child(lane));
        if entry.near < best.near {
            std::mem::swap(&mut entry, &mut best);
        }
        let mut place = *top;
        while place > bottom && stack[place - 1].near < entry.near {
            stack[place] = stack[place - 1];
            place -= 1;
        }
        stack[place] = entry;
        *top += 1;
    }
    Some(best.what)
}

/// What is on top of the stack and still of interest.
#[inline(always)]
pub fn pop<T: Copy>(stack: &[Entry<T>], top: &mut usize, limit: f32) -> Option<T> {
    while *top > 0 {
        *top -= 1;
        // What starts exactly at the limit may hold an equal t of a lower primitive.
        if stack[*top].near <= limit {
            return Some(stack[*top].what);
        }
    }
    None
}
