//! The interface of leaf storage. The f32 pretest ([`super::pretest`]) rejects most triangles of a leaf in parallel,
//! and f64 decides the rest.

use super::bracket::Bracket;
use super::leaf_rows::Rows;
use super::pretest::{BlockRay, BlockRays, sum};
use super::spread_triangles::Spread;
use super::{Column, EdgeRay, PlainRays, RAYS};
use raywright_base::math::{DVec3, Region};
use raywright_base::simd::Lanes;

/// The number type of stored coordinates.
pub trait Real: Copy + Default + Into<f64> + Send + Sync + 'static {
    /// Store a number in the lanes of `mask`.
    fn spread<S: Lanes<RAYS>>(self, simd: S, mask: u32, to: &mut Column<Self>);
}

impl Real for f32 {
    #[inline(always)]
    fn spread<S: Lanes<RAYS>>(self, simd: S, mask: u32, to: &mut Column<f32>) {
        simd.store_some(mask, simd.splat(self), to);
    }
}

impl Real for f64 {
    #[inline(always)]
    fn spread<S: Lanes<RAYS>>(self, _: S, mask: u32, to: &mut Column<f64>) {
        for (i, to) in to.iter_mut().enumerate() {
            *to = if mask >> i & 1 == 1 { self } else { *to };
        }
    }
}

/// The triangles of all leaves, at most `N` per leaf. A leaf is identified by the index of its first triangle and their
/// count.
pub trait Leaves<const N: usize>: Send + Sync + Sized + 'static {
    /// The name of the precision.
    const PRECISION: &'static str;

    /// The number type of stored coordinates.
    type Real: Real;

    /// Store triangles leaf by leaf, given their indices, the counts per leaf, and a function for their corners.
    ///
    /// # Panics
    ///
    /// If a leaf has more than `N`, or the counts do not sum to the number of triangles.
    fn new(region: &Region, order: &[u32], counts: &[u32], corners: impl Fn(u32) -> [DVec3; 3] + Sync) -> Self;

    /// The f32 coordinates and the indices of the triangles.
    fn rows(&self) -> &Rows<N>;

    /// The original corners of the triangle in a lane of a leaf.
    fn corners(&self, first: usize, count: u32, lane: usize) -> [DVec3; 3];

    /// Their stored coordinates.
    fn coordinates(&self, first: usize, count: u32, lane: usize) -> [[Self::Real; 3]; 3];

    /// Prepare a ray for the pretest.
    fn ray(ray: &EdgeRay, region: &Region) -> BlockRay;

    /// Prepare sixteen rays for the pretest.
    fn take<S: Lanes<RAYS>>(simd: S, rays: &PlainRays, region: &Region, to: &mut BlockRays);

    /// Memory use in bytes.
    fn bytes(&self) -> usize;

    /// The index of the triangle in a lane of a leaf.
    #[inline(always)]
    fn primitive(&self, first: usize, count: u32, lane: usize) -> u32 {
        self.rows().primitive(first, count, lane)
    }

    /// The indices of the triangles of a leaf.
    fn primitives(&self, first: usize, count: u32) -> impl Iterator<Item = u32> {
        (0..count as usize).map(move |lane| self.primitive(first, count, lane))
    }

    /// The address of a leaf's pretest data, for prefetching only.
    #[inline(always)]
    fn place(&self, first: usize) -> *const u8 {
        self.rows().place(first)
    }

    /// True if the pretest data are a corner and its two edges, in box units, rather than three corners.
    const EDGES: bool;

    /// The lanes of a leaf that the pretest cannot reject.
    #[inline(always)]
    fn not_rejected<S: Lanes<N>>(&self, simd: S, ray: &BlockRay, first: usize, count: u32) -> u32 {
        self.rows().not_rejected(simd, ray, first, count, Self::EDGES)
    }

    /// The factor from `t` along a ray's scaled direction to that of the pretest, a power of two.
    fn unit(region: &Region) -> f64;

    /// Test a ray against the triangles of a leaf in f32.
    #[inline(always)]
    fn bracket<S: Lanes<N>>(&self, simd: S, ray: &BlockRay, first: usize, count: u32) -> Bracket<S::F32> {
        self.rows().bracket(simd, ray, first, count, Self::EDGES)
    }

    /// The triangles of a leaf prepared for sixteen rays.
    #[inline(always)]
    fn spread<S: Lanes<N>>(&self, simd: S, rays: &BlockRays, first: usize, count: u32) -> Spread<N> {
        self.rows().spread(simd, rays, first, count, Self::EDGES)
    }

    /// The corners of a leaf's triangles in f32, axis by axis, in error by at most four roundings of the largest
    /// coordinate.
    #[inline(always)]
    fn nearly<S: Lanes<N>>(&self, simd: S, first: usize, count: u32) -> [[S::F32; 3]; 3] {
        let rows = self.rows();
        let a = rows.numbers(simd, first, count, 0);
        let b = rows.numbers(simd, first, count, 1);
        let c = rows.numbers(simd, first, count, 2);
        if Self::EDGES { [a, sum(simd, a, b), sum(simd, a, c)] } else { [a, b, c] }
    }
}
