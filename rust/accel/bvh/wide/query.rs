//! What is asked of each ray: its closest hit, or whether there is any.

use crate::math::Hit;
use crate::shapes::triangle::{BlockRay, EdgeRay, TriangleBlock};
use crate::simd::Simd;

/// A ray as blocks of triangles see it.
#[derive(Clone, Copy)]
pub struct LeafRay<'a, const N: usize, S: Simd<N>> {
    pub lanes: &'a BlockRay<N, S>,
    pub edges: &'a EdgeRay,
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
