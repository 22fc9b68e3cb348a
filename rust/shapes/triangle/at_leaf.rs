//! Sixteen rays at a leaf: each triangle against those that are there, in f32 first, and in f64 those that are left.

use super::leaves::{Leaves, Sixteen};
use super::sixteen::RAYS;
use crate::shapes::{Candidate, Contact};
use crate::simd::Simd;

impl Sixteen<'_> {
    /// So many rays or fewer are decided in f64 one by one.
    const FEW: u32 = 2;

    /// See [`Leaves::meet_sixteen`].
    #[inline(always)]
    pub(super) fn meet<const N: usize, L: Leaves<N>, S: Simd<N>>(
        &self,
        simd: S,
        leaves: &L,
        first: usize,
        count: u32,
        active: u32,
        mut met: impl FnMut(usize, u32, Candidate),
    ) {
        let left = self.not_rejected(simd, leaves, first, count, active);
        for lane in 0..count as usize {
            let mut rays = left[lane & 7];
            if rays == 0 {
                continue;
            }
            let corners = leaves.corners(first, count, lane);
            let primitive = leaves.primitive(first, count, lane);
            if rays.count_ones() > Self::FEW {
                let all = self.edges.meet(corners, rays);
                rays = all.open;
                let mut certain = all.met;
                while certain != 0 {
                    let i = certain.trailing_zeros() as usize & (RAYS - 1);
                    certain &= certain - 1;
                    let uv = [all.uv[0][i], all.uv[1][i]];
                    met(i, primitive, Candidate { t: all.t[i], uv, contact: Contact::Inside, inner: 0 });
                }
            }
            while rays != 0 {
                let i = rays.trailing_zeros() as usize & (RAYS - 1);
                rays &= rays - 1;
                if let Some(candidate) = self.one(i).and_then(|ray| ray.meet(corners)) {
                    met(i, primitive, candidate);
                }
            }
        }
    }

    /// By lane of a leaf, those of the rays in `active` that may meet its triangle.
    #[inline(always)]
    fn not_rejected<const N: usize, L: Leaves<N>, S: Simd<N>>(
        &self,
        simd: S,
        leaves: &L,
        first: usize,
        count: u32,
        active: u32,
    ) -> [u32; 8] {
        let mut left = [0u32; 8];
        if active.count_ones() > 2 * count {
            for lane in 0..count as usize {
                left[lane & 7] = active & leaves.rays_not_rejected(simd, self.blocks, first, count, lane);
            }
        } else {
            let mut rest = active;
            while rest != 0 {
                let i = rest.trailing_zeros() as usize & (RAYS - 1);
                rest &= rest - 1;
                let mut lanes = leaves.not_rejected(simd, &self.blocks.of(i), first, count);
                while lanes != 0 {
                    left[lanes.trailing_zeros() as usize & 7] |= 1 << i;
                    lanes &= lanes - 1;
                }
            }
        }
        left
    }
}
