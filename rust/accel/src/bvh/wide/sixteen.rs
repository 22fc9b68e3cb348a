//! Sixteen rays prepared for nodes and leaves.

use super::best::between_all;
use super::node::Packed;
use super::step::Boxes;
use crate::slab::SlabRays;
use raywright_base::math::{Axes, RayBatch, Region};
use raywright_base::simd::Lanes;
use raywright_shapes::triangle::{BlockRays, Column, Leaves, PlainRays, RAYS};

/// Sixteen rays of a batch. The data of rays that are not plain are undefined.
#[derive(Debug)]
pub struct Sixteen {
    pub plain: PlainRays,
    pub slabs: SlabRays,
    pub blocks: BlockRays,
    /// An interval for the `t_min` of each ray, in the units of leaves ([`Leaves::unit`]).
    pub t_min: [Column<f32>; 2],
    /// An interval for the `t_max` of each ray.
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

    /// Let several sixteens share their error bounds for triangles.
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

    /// Load up to sixteen rays, at least one. The last one fills missing places.
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
        L::take(simd, &self.plain, region, &mut self.blocks);
        let unit = simd.splat(L::unit(region) as f32);
        for (to, t) in [(&mut self.t_min, &self.plain.t_min), (&mut self.t_max, &self.plain.t_max)] {
            let (low, high) = between_all(simd, simd.mul(simd.load(t), unit));
            simd.store(low, &mut to[0]);
            simd.store(high, &mut to[1]);
        }
    }

    /// Their origins in box units, along the tree's own axes if any.
    #[inline(always)]
    pub fn origins(&self) -> &[Column<f32>; 3] {
        self.slabs.turned.as_ref().unwrap_or(&self.plain.local)
    }

    /// One of the rays, at a child, with an empty stack that starts at `bottom`.
    #[inline(always)]
    pub fn boxes(&self, i: usize, limit: f32, at: Packed, bottom: usize) -> Boxes {
        Boxes::of(&self.slabs, i, limit, at, bottom)
    }
}
