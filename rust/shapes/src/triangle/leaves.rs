//! The triangles of a tree's leaves. Those of one leaf are tested side by side: most are rejected together in f32
//! ([`super::pretest`]), the few that are left are decided in f64.

use super::bracket::Bracket;
use super::pretest::{BlockRay, BlockRays, sum};
use super::rows::Rows;
use super::spread::Spread;
use super::{Column, EdgeRay, PlainRays, RAYS};
use raywright_base::math::{DVec3, Region};
use raywright_base::simd::Lanes;

/// What coordinates are kept in.
pub trait Real: Copy + Default + Into<f64> + Send + Sync + 'static {
    /// Puts a number in the lanes of `mask`.
    fn spread<S: Lanes<RAYS>>(self, simd: S, mask: u32, to: &mut Column<Self>);
}

impl Real for f32 {
    #[inline(always)]
    fn spread<S: Lanes<RAYS>>(self, simd: S, mask: u32, to: &mut Column<f32>) {
        simd.store(simd.select(mask, simd.splat(self), simd.load(to)), to);
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

/// All triangles of a tree, leaf by leaf: at most `N` a leaf, known by where its first stands and how many they are.
pub trait Leaves<const N: usize>: Send + Sync + Sized + 'static {
    /// How numbers are kept, in a word.
    const PRECISION: &'static str;

    /// What coordinates are kept in.
    type Real: Real;

    /// Triangles by their numbers, leaf by leaf; how many each leaf has; and where the corners of each are.
    ///
    /// # Panics
    /// If a leaf has more than `N`, or the counts do not add up to the triangles.
    fn new(region: &Region, order: &[u32], counts: &[u32], corners: impl Fn(u32) -> [DVec3; 3] + Sync) -> Self;

    /// The coordinates in f32, and the numbers of the triangles.
    fn rows(&self) -> &Rows<N>;

    /// The corners of the triangle in a lane of a leaf, as they were given.
    fn corners(&self, first: usize, count: u32, lane: usize) -> [DVec3; 3];

    /// Their coordinates.
    fn coordinates(&self, first: usize, count: u32, lane: usize) -> [[Self::Real; 3]; 3];

    /// A ray as the first test needs it.
    fn ray(ray: &EdgeRay, region: &Region) -> BlockRay;

    /// Sixteen rays as the first test needs them.
    fn rays<S: Lanes<RAYS>>(simd: S, rays: &PlainRays, region: &Region) -> BlockRays;

    /// Memory held.
    fn bytes(&self) -> usize;

    /// The number of the triangle in a lane of a leaf.
    #[inline(always)]
    fn primitive(&self, first: usize, count: u32, lane: usize) -> u32 {
        self.rows().primitive(first, count, lane)
    }

    /// The numbers of the triangles of a leaf.
    fn primitives(&self, first: usize, count: u32) -> impl Iterator<Item = u32> {
        (0..count as usize).map(move |lane| self.primitive(first, count, lane))
    }

    /// Where the first test finds a leaf. The address is only asked for.
    #[inline(always)]
    fn place(&self, first: usize) -> *const u8 {
        self.rows().place(first)
    }

    /// Whether the first test finds a corner and the edges from there, in box units, instead of three corners.
    const EDGES: bool;

    /// Of the lanes of a leaf, those that the first test cannot reject.
    #[inline(always)]
    fn not_rejected<S: Lanes<N>>(&self, simd: S, ray: &BlockRay, first: usize, count: u32) -> u32 {
        self.rows().not_rejected(simd, ray, first, count, Self::EDGES)
    }

    /// From `t` along a ray's scaled direction to that of the first test: a power of two.
    fn unit(region: &Region) -> f64;

    /// What f32 knows of a ray and the triangles of a leaf.
    #[inline(always)]
    fn bracket<S: Lanes<N>>(&self, simd: S, ray: &BlockRay, first: usize, count: u32) -> Bracket<S::F32> {
        self.rows().bracket(simd, ray, first, count, Self::EDGES)
    }

    /// The triangles of a leaf for sixteen rays.
    #[inline(always)]
    fn spread<S: Lanes<N>>(&self, simd: S, rays: &BlockRays, first: usize, count: u32) -> Spread<N> {
        self.rows().spread(simd, rays, first, count, Self::EDGES)
    }

    /// The corners of the triangles of a leaf in f32, axis by axis: off by no more than four roundings of the largest
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
