//! A batch of rays for one tree, by the kernel that suits them.

use super::query::Query;
use super::{WideBvh, single, wave};
use crate::math::{Ray, coherence};
use crate::simd::{Kernel, Simd};

/// Fewer rays than these leave a wave mostly empty.
const FEW: usize = 8;

/// A batch of rays, answered into `out`.
pub struct Batch<'a, const N: usize, Q> {
    pub bvh: &'a WideBvh<N>,
    pub rays: &'a [Ray],
    pub out: Q,
}

impl<const N: usize, Q: Query<N>> Kernel<N> for Batch<'_, N, Q> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd<N>>(mut self, simd: S) {
        if self.bvh.nodes.is_empty() {
            for i in 0..self.rays.len() {
                self.out.finish(i, None);
            }
        } else if self.rays.len() < FEW || coherence::is_coherent(self.rays, self.bvh.extent) {
            single::answer(simd, self.bvh, self.rays, &mut self.out);
        } else {
            wave::answer(simd, self.bvh, self.rays, &mut self.out);
        }
    }
}
