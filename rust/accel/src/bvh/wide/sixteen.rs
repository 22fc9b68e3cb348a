//! Sixteen rays made ready for nodes and for leaves.

use super::best::between_all;
use super::node::Packed;
use super::step::Boxes;
use crate::slab::SlabRays;
use raywright_base::math::{Axes, RayBatch, Region};
use raywright_base::simd::Lanes;
use raywright_shapes::triangle::{BlockRays, Column, Leaves, PlainRays, RAYS};

/// Sixteen rays of a batch; of those that are not plain nothing is said.
#[derive(Debug)]
pub struct Sixteen {
    pub plain: PlainRays,
    pub slabs: SlabRays,
    pub blocks: BlockRays,
    /// Between these lies the `t_min` of each, in the units of leaves ([`Leaves::unit`]).
    pub t_min: [Column<f32>; 2],
    /// Between these lies the `t_max` of each.
    pub t_max: [Column<f32>; 2],
}

impl Sixteen {
    /// No rays.
    pub const NONE: Self = Self {
        plain: PlainRays::NONE,
        slabs: SlabRays::NONE,
        blocks: BlockRays::NONE,
        t_min: [[0.0; RAYS]; 2],
        t_max: [[0.0; RAYS]; 2],
    };

    /// Has some of them meet triangles by the same bounds.
    #[inline(always)]
    pub fn unite(some: &mut [Self]) {
        let Some((sixteen, others)) = some.split_first_mut() else { return };
        for other in &*others {
            sixteen.blocks.unite(&other.blocks);
        }
        for other in others {
            other.blocks.unite(&sixteen.blocks);
        }
    }

    /// Takes up to sixteen rays, at least one; the last stands for those that are missing.
    #[inline(always)]
    pub fn take<const N: usize, L: Leaves<N>, S: Lanes<RAYS>>(
        &mut self,
        simd: S,
        rays: &RayBatch<'_>,
        from: usize,
        region: &Region,
        axes: Option<&Axes>,
    ) {
        self.plain.take(simd, rays, from, region);
        self.slabs.prepare(simd, &self.plain, region, axes);
        self.blocks = L::rays(simd, &self.plain, region);
        let unit = simd.splat(L::unit(region) as f32);
        for (to, t) in [(&mut self.t_min, &self.plain.t_min), (&mut self.t_max, &self.plain.t_max)] {
            let (low, high) = between_all(simd, simd.mul(simd.load(t), unit));
            simd.store(low, &mut to[0]);
            simd.store(high, &mut to[1]);
        }
    }

    /// Where they start, by axes of the boxes, in their units.
    #[inline(always)]
    pub fn origins(&self) -> &[Column<f32>; 3] {
        self.slabs.turned.as_ref().unwrap_or(&self.plain.local)
    }

    /// One of them, at a child, with nothing on the stack that starts at `bottom`.
    #[inline(always)]
    pub fn boxes(&self, i: usize, limit: f32, at: Packed, bottom: usize) -> Boxes {
        Boxes::of(&self.slabs, i, limit, at, bottom)
    }
}
