//! Several triangles side by side: most are rejected together in f32, the few that are left are decided in f64.
//!
//! The f32 test rejects a triangle only where one weight (see [`super::edge`]) is certainly positive and another certainly
//! negative. The bound. Let v = 2⁻²⁴, E bound every coordinate of the triangle's edges, L bound |origin| + |corner| in
//! every coordinate, and D < 2 those of the direction. An edge p, the difference of two corners, errs by vE. The sum q of two
//! corners relative to the origin errs by 2vL for rounding the origin, 2vL for the two differences and 2vL for the sum, and
//! is at most 2L. So a product errs by 2vEL + 6vEL + 2vEL = 10vEL, a component of p × q by twice that and 4vEL more, 24vEL, and its
//! product with d by 2·24vEL + 2v·4EL for rounding d + v·8EL = 64vEL. The sum of three errs by 3·64vEL + v·(16 + 24)EL =
//! 232vEL, to first order; fused operations err less. 256vEL is allowed, and 2⁻¹²⁶ more for what underflows: six products
//! that lose at most 2⁻¹⁴⁹ each, times 2. (The least normal number: a subnormal one would make every sum slow.) With L below
//! 2⁶⁰ no sum exceeds 48L² < 2¹²⁶; beyond it, where infinities of either sign may appear, nothing is rejected.
//!
//! Where corners are rounded to f32 themselves, by vL each, p errs by 2vL more and q too. That of p makes 4vL² in a product, 8vL²
//! in a component, 16vL² with d and 48vL² in the sum; that of q 2vEL, 4vEL, 8vEL and 24vEL. 64vL² and 320vEL are allowed in all.

use super::{Candidate, EdgeRay};
use crate::math::{DVec3, Region, Vec3};
use crate::simd::Simd;

/// Up to `N` triangles whose coordinates are f32 as given, one a lane.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct TriangleBlock<const N: usize> {
    lanes: Lanes<N>,
}

/// Up to `N` triangles whose coordinates are f64: rounded for the first test, and as they are.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct DoubleBlock<const N: usize> {
    /// In box units.
    lanes: Lanes<N>,
    corners: [[DVec3; 3]; N],
}

/// What stands in the leaves of a tree.
pub trait Leaf<const N: usize>: Send + Sync + 'static {
    /// How numbers are kept, in a word.
    const PRECISION: &'static str;

    /// A leaf of at most `N` triangles, given with their numbers.
    ///
    /// # Panics
    /// If there are more.
    fn new(region: &Region, triangles: impl IntoIterator<Item = (u32, [DVec3; 3])>) -> Self;

    /// What the first test needs.
    fn lanes(&self) -> &Lanes<N>;

    /// The corners in a lane, as they were given.
    fn corners(&self, lane: usize) -> [DVec3; 3];

    /// A ray as the first test needs it.
    fn ray<S: Simd<N>>(simd: S, ray: &EdgeRay, region: &Region) -> BlockRay<N, S>;

    /// Calls `met` with each triangle in the first `count` lanes that the ray meets, until it says true; then that is said.
    #[inline(always)]
    fn meet<S: Simd<N>>(
        &self,
        simd: S,
        lanes: &BlockRay<N, S>,
        ray: &EdgeRay,
        count: u32,
        mut met: impl FnMut(u32, Candidate) -> bool,
    ) -> bool {
        let mut left = self.lanes().not_rejected(simd, lanes, count);
        while left != 0 {
            let lane = left.trailing_zeros() as usize & (N - 1);
            left &= left - 1;
            if let Some(candidate) = ray.meet(self.corners(lane))
                && met(self.lanes().primitives[lane], candidate)
            {
                return true;
            }
        }
        false
    }
}

/// The most that a coordinate may be for the test in f32 to reject anything.
const OVERFLOW: f64 = (1u64 << 60) as f64;

impl<const N: usize> Leaf<N> for TriangleBlock<N> {
    const PRECISION: &'static str = "single";

    fn new(_: &Region, triangles: impl IntoIterator<Item = (u32, [DVec3; 3])>) -> Self {
        Self { lanes: Lanes::new(triangles.into_iter().map(|(p, c)| (p, c.map(|c| c.as_vec3())))) }
    }

    #[inline(always)]
    fn lanes(&self) -> &Lanes<N> {
        &self.lanes
    }

    #[inline(always)]
    fn corners(&self, lane: usize) -> [DVec3; 3] {
        let corner = |c: &[[f32; N]; 3]| Vec3::new(c[0][lane], c[1][lane], c[2][lane]).as_dvec3();
        [corner(&self.lanes.corners[0]), corner(&self.lanes.corners[1]), corner(&self.lanes.corners[2])]
    }

    #[inline(always)]
    fn ray<S: Simd<N>>(simd: S, ray: &EdgeRay, _: &Region) -> BlockRay<N, S> {
        const ERROR: f64 = 1.0 / (1u64 << 16) as f64;
        let error = if ray.absolute < OVERFLOW { ERROR * ray.absolute } else { f64::INFINITY };
        BlockRay::new(simd, ray.origin, ray.direction, error, 0.0)
    }
}

impl<const N: usize> Leaf<N> for DoubleBlock<N> {
    const PRECISION: &'static str = "double";

    fn new(region: &Region, triangles: impl IntoIterator<Item = (u32, [DVec3; 3])>) -> Self {
        let mut corners = [[DVec3::ZERO; 3]; N];
        let rounded = triangles.into_iter().enumerate().map(|(lane, (p, c))| {
            corners[lane] = c;
            (p, c.map(|c| region.to_box(c).as_vec3()))
        });
        let lanes = Lanes::new(rounded);
        Self { lanes, corners }
    }

    #[inline(always)]
    fn lanes(&self) -> &Lanes<N> {
        &self.lanes
    }

    #[inline(always)]
    fn corners(&self, lane: usize) -> [DVec3; 3] {
        self.corners[lane]
    }

    #[inline(always)]
    fn ray<S: Simd<N>>(simd: S, ray: &EdgeRay, region: &Region) -> BlockRay<N, S> {
        const ERROR: f64 = 320.0 / (1u64 << 24) as f64;
        const CORNERS: f64 = 64.0 / (1u64 << 24) as f64;
        // |origin| + |corner|, both relative to the centre and in box units.
        let largest = ray.largest * region.scale;
        let error = if largest < OVERFLOW { ERROR * largest } else { f64::INFINITY };
        BlockRay::new(simd, ray.local * region.scale, ray.direction, error, CORNERS * largest * largest)
    }
}

/// The coordinates of up to `N` triangles in f32, one a lane.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Lanes<const N: usize> {
    /// By corner and axis.
    corners: [[[f32; N]; 3]; 3],
    /// The number of each triangle among all.
    primitives: [u32; N],
}

/// What the test in f32 needs of a ray, in every lane.
#[derive(Clone, Copy)]
pub struct BlockRay<const N: usize, S: Simd<N>> {
    origin: [S::F32; 3],
    direction: [S::F32; 3],
    /// The bound on the error of a weight over the largest edge.
    error: S::F32,
    /// What is added to it.
    least: S::F32,
}

impl<const N: usize, S: Simd<N>> BlockRay<N, S> {
    /// Rounds a ray to f32.
    #[inline(always)]
    fn new(simd: S, origin: DVec3, direction: DVec3, error: f64, least: f64) -> Self {
        let (o, d) = (origin.as_vec3(), direction.as_vec3());
        Self {
            origin: [simd.splat(o.x), simd.splat(o.y), simd.splat(o.z)],
            direction: [simd.splat(d.x), simd.splat(d.y), simd.splat(d.z)],
            // Rounded to nearest: the error of that is among those of higher order.
            error: simd.splat(error as f32),
            least: simd.splat(least as f32 + f32::MIN_POSITIVE),
        }
    }
}

impl<const N: usize> Lanes<N> {
    fn new(triangles: impl IntoIterator<Item = (u32, [Vec3; 3])>) -> Self {
        let mut block = Self { corners: [[[0.0; N]; 3]; 3], primitives: [u32::MAX; N] };
        for (lane, (primitive, corners)) in triangles.into_iter().enumerate() {
            block.primitives[lane] = primitive;
            for (to, corner) in block.corners.iter_mut().zip(corners) {
                for axis in 0..3 {
                    to[axis][lane] = corner[axis];
                }
            }
        }
        block
    }

    /// The numbers of the triangles; `u32::MAX` in empty lanes.
    pub fn primitives(&self) -> &[u32; N] {
        &self.primitives
    }

    /// Of the first `count` lanes, those that f32 cannot reject.
    // Written out, axis by axis: closures and iterators between here and the kernel's entry are not always compiled for
    // its level, and then every operation is a call.
    #[inline(always)]
    fn not_rejected<S: Simd<N>>(&self, simd: S, ray: &BlockRay<N, S>, count: u32) -> u32 {
        let a = load(simd, &self.corners[0]);
        let b = load(simd, &self.corners[1]);
        let c = load(simd, &self.corners[2]);
        let (bc, ca, ab) = (difference(simd, b, c), difference(simd, c, a), difference(simd, a, b));
        let (a, b, c) =
            (difference(simd, a, ray.origin), difference(simd, b, ray.origin), difference(simd, c, ray.origin));
        let u = volume(simd, ray.direction, bc, b, c);
        let v = volume(simd, ray.direction, ca, c, a);
        let w = volume(simd, ray.direction, ab, a, b);

        let largest = simd.max(simd.max(largest(simd, bc), largest(simd, ca)), largest(simd, ab));
        let above = simd.mul_add(largest, ray.error, ray.least);
        let below = simd.neg(above);
        let positive = simd.gt(u, above) | simd.gt(v, above) | simd.gt(w, above);
        let negative = simd.gt(below, u) | simd.gt(below, v) | simd.gt(below, w);
        !(positive & negative) & ((1 << count) - 1)
    }
}

#[inline(always)]
fn load<const N: usize, S: Simd<N>>(simd: S, corner: &[[f32; N]; 3]) -> [S::F32; 3] {
    [simd.load(&corner[0]), simd.load(&corner[1]), simd.load(&corner[2])]
}

#[inline(always)]
fn difference<const N: usize, S: Simd<N>>(simd: S, a: [S::F32; 3], b: [S::F32; 3]) -> [S::F32; 3] {
    [simd.sub(a[0], b[0]), simd.sub(a[1], b[1]), simd.sub(a[2], b[2])]
}

/// The largest coordinate in magnitude.
#[inline(always)]
fn largest<const N: usize, S: Simd<N>>(simd: S, v: [S::F32; 3]) -> S::F32 {
    simd.max(simd.max(simd.abs(v[0]), simd.abs(v[1])), simd.abs(v[2]))
}

/// `d · (p × (v + w))` with `p = v − w`.
#[inline(always)]
fn volume<const N: usize, S: Simd<N>>(
    simd: S,
    d: [S::F32; 3],
    p: [S::F32; 3],
    v: [S::F32; 3],
    w: [S::F32; 3],
) -> S::F32 {
    let q = [simd.add(v[0], w[0]), simd.add(v[1], w[1]), simd.add(v[2], w[2])];
    let x = simd.mul_sub(p[1], q[2], simd.mul(p[2], q[1]));
    let y = simd.mul_sub(p[2], q[0], simd.mul(p[0], q[2]));
    let z = simd.mul_sub(p[0], q[1], simd.mul(p[1], q[0]));
    simd.mul_add(d[2], z, simd.mul_add(d[1], y, simd.mul(d[0], x)))
}
