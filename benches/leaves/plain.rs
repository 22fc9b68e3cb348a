//! Leaves as in most ray tracers: the f32 test of Möller and Trumbore (1997), whose result is final.

use raywright::math::{DVec3, Region};
use raywright::shapes::triangle::{BlockRay, BlockRays, Bracket, EdgeRay, Leaves, PlainRays, RAYS, Rows, SingleLeaves};
use raywright::simd::Lanes;

/// Triangles stored like [`SingleLeaves`], in the same order.
pub struct PlainLeaves<const N: usize>(SingleLeaves<N>);

impl<const N: usize> Leaves<N> for PlainLeaves<N> {
    const PRECISION: &'static str = "plain";
    type Real = f32;
    const EDGES: bool = false;

    fn new(region: &Region, order: &[u32], counts: &[u32], corners: impl Fn(u32) -> [DVec3; 3] + Sync) -> Self {
        Self(SingleLeaves::new(region, order, counts, corners))
    }

    #[inline(always)]
    fn rows(&self) -> &Rows<N> {
        self.0.rows()
    }

    #[inline(always)]
    fn corners(&self, first: usize, count: u32, lane: usize) -> [DVec3; 3] {
        self.0.corners(first, count, lane)
    }

    #[inline(always)]
    fn coordinates(&self, first: usize, count: u32, lane: usize) -> [[f32; 3]; 3] {
        self.0.coordinates(first, count, lane)
    }

    #[inline(always)]
    fn ray(ray: &EdgeRay, region: &Region) -> BlockRay {
        <SingleLeaves<N> as Leaves<N>>::ray(ray, region)
    }

    #[inline(always)]
    fn take<S: Lanes<RAYS>>(simd: S, rays: &PlainRays, region: &Region, to: &mut BlockRays) {
        <SingleLeaves<N> as Leaves<N>>::take(simd, rays, region, to);
        to.believe();
    }

    #[inline(always)]
    fn unit(region: &Region) -> f64 {
        <SingleLeaves<N> as Leaves<N>>::unit(region)
    }

    fn bytes(&self) -> usize {
        self.0.bytes()
    }

    #[inline(always)]
    fn bracket<S: Lanes<N>>(&self, simd: S, ray: &BlockRay, first: usize, count: u32) -> Bracket<S::F32> {
        let (o, d) = (&ray.origin, &ray.direction);
        let o = [simd.splat(o[0]), simd.splat(o[1]), simd.splat(o[2])];
        let d = [simd.splat(d[0]), simd.splat(d[1]), simd.splat(d[2])];
        let a = self.rows().numbers(simd, first, count, 0);
        let b = self.rows().numbers(simd, first, count, 1);
        let c = self.rows().numbers(simd, first, count, 2);
        let triangle = [a, difference(simd, b, a), difference(simd, c, a)];
        moller_trumbore(simd, triangle, o, d, (1 << count) - 1)
    }
}

/// Intersect triangles stored by corner and edges.
#[inline(always)]
fn moller_trumbore<const N: usize, S: Lanes<N>>(
    simd: S,
    [a, e, f]: [[S::F32; 3]; 3],
    o: [S::F32; 3],
    d: [S::F32; 3],
    lanes: u32,
) -> Bracket<S::F32> {
    let s = difference(simd, o, a);
    let p = cross(simd, d, f);
    let q = cross(simd, s, e);
    let (u, v) = (dot(simd, s, p), dot(simd, d, q));
    let denominator = dot(simd, e, p);
    let t = simd.div(dot(simd, f, q), denominator);
    let w = simd.sub(simd.sub(denominator, u), v);
    let zero = simd.splat(0.0);
    let positive = simd.gt(u, zero) | simd.gt(v, zero) | simd.gt(w, zero);
    let negative = simd.gt(zero, u) | simd.gt(zero, v) | simd.gt(zero, w);
    let met = !(positive & negative) & lanes;
    Bracket { possible: met, inside: met, known: lanes, low: t, high: t }
}

#[inline(always)]
fn difference<const N: usize, S: Lanes<N>>(simd: S, a: [S::F32; 3], b: [S::F32; 3]) -> [S::F32; 3] {
    [simd.sub(a[0], b[0]), simd.sub(a[1], b[1]), simd.sub(a[2], b[2])]
}

#[inline(always)]
fn cross<const N: usize, S: Lanes<N>>(simd: S, a: [S::F32; 3], b: [S::F32; 3]) -> [S::F32; 3] {
    [
        simd.mul_sub(a[1], b[2], simd.mul(a[2], b[1])),
        simd.mul_sub(a[2], b[0], simd.mul(a[0], b[2])),
        simd.mul_sub(a[0], b[1], simd.mul(a[1], b[0])),
    ]
}

#[inline(always)]
fn dot<const N: usize, S: Lanes<N>>(simd: S, a: [S::F32; 3], b: [S::F32; 3]) -> S::F32 {
    simd.mul_add(a[0], b[0], simd.mul_add(a[1], b[1], simd.mul(a[2], b[2])))
}
