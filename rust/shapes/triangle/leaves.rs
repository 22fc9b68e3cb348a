//! The triangles of a tree's leaves. Those of one leaf are tested side by side: most are rejected together in f32
//! ([`super::pretest`]), the few that are left are decided in f64.

use super::pretest::{difference, not_rejected, sum};
use super::{BlockRay, BlockRays, Column, EdgeRay, EdgeRays, RAYS, Sixteen};
use crate::math::{DVec3, Region, Vec3};
use crate::shapes::Candidate;
use crate::simd::Simd;
use rayon::prelude::*;

/// All triangles of a tree, leaf by leaf: at most `N` a leaf, known by where its first stands and how many they are.
pub trait Leaves<const N: usize>: Send + Sync + Sized + 'static {
    /// How numbers are kept, in a word.
    const PRECISION: &'static str;

    /// Triangles by their numbers, leaf by leaf; how many each leaf has; and where the corners of each are.
    ///
    /// # Panics
    /// If a leaf has more than `N`, or the counts do not add up to the triangles.
    fn new(region: &Region, order: &[u32], counts: &[u32], corners: impl Fn(u32) -> [DVec3; 3] + Sync) -> Self;

    /// The coordinates in f32, and the numbers of the triangles.
    fn rows(&self) -> &Rows<N>;

    /// The corners of the triangle in a lane of a leaf, as they were given.
    fn corners(&self, first: usize, count: u32, lane: usize) -> [DVec3; 3];

    /// A ray as the first test needs it.
    fn ray(ray: &EdgeRay, region: &Region) -> BlockRay;

    /// Sixteen rays as the first test needs them.
    fn rays(rays: &EdgeRays, region: &Region) -> BlockRays;

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
        self.rows().numbers.as_ptr().wrapping_add(first * ROWS).cast()
    }

    /// Whether the first test finds a corner and the edges from there, in box units, instead of three corners.
    const EDGES: bool;

    /// Of the lanes of a leaf, those that the first test cannot reject.
    #[inline(always)]
    fn not_rejected<S: Simd<N>>(&self, simd: S, ray: &BlockRay, first: usize, count: u32) -> u32 {
        self.rows().not_rejected(simd, ray, first, count, Self::EDGES)
    }

    /// Of sixteen rays, those for which the first test cannot reject the triangle in a lane of a leaf.
    #[inline(always)]
    fn rays_not_rejected<S: Simd<N>>(&self, simd: S, rays: &BlockRays, first: usize, count: u32, lane: usize) -> u32 {
        self.rows().rays_not_rejected(simd, rays, first, count, lane, Self::EDGES)
    }

    /// The corners of the triangles of a leaf in f32, axis by axis: off by no more than four roundings of the largest coordinate.
    #[inline(always)]
    fn nearly<S: Simd<N>>(&self, simd: S, first: usize, count: u32) -> [[S::F32; 3]; 3] {
        let rows = self.rows();
        let a = rows.numbers(simd, first, count, 0);
        let b = rows.numbers(simd, first, count, 1);
        let c = rows.numbers(simd, first, count, 2);
        if Self::EDGES { [a, sum(simd, a, b), sum(simd, a, c)] } else { [a, b, c] }
    }

    /// Calls `met` with each triangle of a leaf that the ray meets, until it says true; then that is said.
    #[inline(always)]
    fn meet<S: Simd<N>>(
        &self,
        simd: S,
        first: usize,
        count: u32,
        lanes: &BlockRay,
        ray: &EdgeRay,
        mut met: impl FnMut(u32, Candidate) -> bool,
    ) -> bool {
        let mut left = self.not_rejected(simd, lanes, first, count);
        while left != 0 {
            let lane = left.trailing_zeros() as usize & (N - 1);
            left &= left - 1;
            if let Some(candidate) = ray.meet(self.corners(first, count, lane))
                && met(self.primitive(first, count, lane), candidate)
            {
                return true;
            }
        }
        false
    }

    /// Calls `met` with each of the rays in `active` and each triangle of a leaf that it meets.
    #[inline(always)]
    fn meet_sixteen<S: Simd<N>>(
        &self,
        simd: S,
        first: usize,
        count: u32,
        rays: &Sixteen,
        active: u32,
        met: impl FnMut(usize, u32, Candidate),
    ) {
        rays.meet(simd, self, first, count, active, met);
    }
}

/// Numbers of a triangle: nine coordinates and which it is.
const ROWS: usize = 10;

/// Triangles whose coordinates are f32.
#[derive(Clone, Debug)]
pub struct SingleLeaves<const N: usize> {
    rows: Rows<N>,
}

/// Triangles whose coordinates are f64: rounded for the first test, and as they are.
#[derive(Clone, Debug)]
pub struct DoubleLeaves<const N: usize> {
    /// In box units.
    rows: Rows<N>,
    corners: Vec<[DVec3; 3]>,
}

impl<const N: usize> Leaves<N> for SingleLeaves<N> {
    const PRECISION: &'static str = "single";
    const EDGES: bool = false;

    fn new(_: &Region, order: &[u32], counts: &[u32], corners: impl Fn(u32) -> [DVec3; 3] + Sync) -> Self {
        // Exact: the coordinates are f32.
        Self { rows: Rows::new(order, counts, |p| corners(p).map(|c| c.as_vec3())) }
    }

    #[inline(always)]
    fn rows(&self) -> &Rows<N> {
        &self.rows
    }

    #[inline(always)]
    fn corners(&self, first: usize, count: u32, lane: usize) -> [DVec3; 3] {
        // Written out: `map` is not always compiled for a kernel's level.
        let [a, b, c] = self.rows.vectors(first, count, lane);
        [a.as_dvec3(), b.as_dvec3(), c.as_dvec3()]
    }

    #[inline(always)]
    fn ray(ray: &EdgeRay, _: &Region) -> BlockRay {
        BlockRay::new(ray.origin, ray, ray.absolute)
    }

    #[inline(always)]
    fn rays(rays: &EdgeRays, _: &Region) -> BlockRays {
        BlockRays::new(&rays.origin, rays, &rays.absolute, 1.0)
    }

    fn bytes(&self) -> usize {
        self.rows.bytes()
    }
}

impl<const N: usize> Leaves<N> for DoubleLeaves<N> {
    const PRECISION: &'static str = "double";
    const EDGES: bool = true;

    fn new(region: &Region, order: &[u32], counts: &[u32], corners: impl Fn(u32) -> [DVec3; 3] + Sync) -> Self {
        let rows = Rows::new(order, counts, |p| {
            let [a, b, c] = corners(p);
            [region.to_box(a).as_vec3(), ((b - a) * region.scale).as_vec3(), ((c - a) * region.scale).as_vec3()]
        });
        Self { rows, corners: order.par_iter().map(|&p| corners(p)).collect() }
    }

    #[inline(always)]
    fn rows(&self) -> &Rows<N> {
        &self.rows
    }

    #[inline(always)]
    fn corners(&self, first: usize, _: u32, lane: usize) -> [DVec3; 3] {
        self.corners[first + lane]
    }

    #[inline(always)]
    fn ray(ray: &EdgeRay, region: &Region) -> BlockRay {
        // |origin| + |corner|, both relative to the centre and in box units.
        BlockRay::new(ray.local * region.scale, ray, ray.largest * region.scale)
    }

    #[inline(always)]
    fn rays(rays: &EdgeRays, region: &Region) -> BlockRays {
        BlockRays::new(&rays.local, rays, &rays.largest, region.scale)
    }

    fn bytes(&self) -> usize {
        self.rows.bytes() + size_of_val(self.corners.as_slice())
    }
}

/// The triangles of all leaves in f32. A leaf of n has n numbers of each row, one row after the other: the coordinates of
/// three vectors by axis, then the triangles' own numbers. So a leaf takes no more memory than its triangles need, and `N` numbers
/// read from any row are those of the leaf and others that do not matter.
#[derive(Clone, Debug)]
pub struct Rows<const N: usize> {
    numbers: Vec<f32>,
}

impl<const N: usize> Rows<N> {
    /// Makes the bits of small whole numbers those of ordinary floats: they are computed with, to no end, by lanes that do not
    /// matter, and subnormal ones would make that slow.
    const MASK: u32 = 0x4000_0000;

    fn new(order: &[u32], counts: &[u32], vectors: impl Fn(u32) -> [Vec3; 3] + Sync) -> Self {
        /// Leaves that a thread fills at a time.
        const SOME: usize = 1024;
        assert_eq!(counts.iter().sum::<u32>() as usize, order.len(), "as many triangles as their counts say");
        // The last row of the last leaf can be read as any other.
        let mut numbers = vec![0.0; order.len() * ROWS + N];
        let mut parts = Vec::with_capacity(counts.len().div_ceil(SOME));
        let (mut rest, mut order) = (numbers.as_mut_slice(), order);
        for counts in counts.chunks(SOME) {
            let triangles = counts.iter().sum::<u32>() as usize;
            let (part, others) = rest.split_at_mut(triangles * ROWS);
            let (mine, more) = order.split_at(triangles);
            parts.push((part, mine, counts));
            (rest, order) = (others, more);
        }
        parts.into_par_iter().for_each(|(mut part, mut order, counts)| {
            for &count in counts {
                let count = count as usize;
                assert!(count <= N, "a leaf has at most {N} triangles");
                let (leaf, others) = part.split_at_mut(count * ROWS);
                let (mine, more) = order.split_at(count);
                for (lane, &primitive) in mine.iter().enumerate() {
                    assert!(primitive < Self::MASK, "fewer than 2^30 triangles");
                    for (which, vector) in vectors(primitive).into_iter().enumerate() {
                        for axis in 0..3 {
                            leaf[(3 * which + axis) * count + lane] = vector[axis];
                        }
                    }
                    leaf[9 * count + lane] = f32::from_bits(primitive | Self::MASK);
                }
                (part, order) = (others, more);
            }
        });
        Self { numbers }
    }

    fn bytes(&self) -> usize {
        size_of_val(self.numbers.as_slice())
    }

    /// The number of the triangle in a lane of a leaf.
    #[inline(always)]
    fn primitive(&self, first: usize, count: u32, lane: usize) -> u32 {
        self.numbers[first * ROWS + 9 * count as usize + lane].to_bits() ^ Self::MASK
    }

    /// The three vectors of the triangle in a lane of a leaf.
    #[inline(always)]
    fn vectors(&self, first: usize, count: u32, lane: usize) -> [Vec3; 3] {
        let count = count as usize;
        let leaf = &self.numbers[first * ROWS + lane..][..8 * count + 1];
        let vector = |c: usize| Vec3::new(leaf[3 * c * count], leaf[(3 * c + 1) * count], leaf[(3 * c + 2) * count]);
        [vector(0), vector(1), vector(2)]
    }

    /// One of the three vectors of the triangles of a leaf, axis by axis.
    #[inline(always)]
    pub fn numbers<S: Simd<N>>(&self, simd: S, first: usize, count: u32, which: usize) -> [S::F32; 3] {
        let count = count as usize;
        let rows = &self.numbers[first * ROWS + 3 * which * count..][..2 * count + N];
        let row = |axis: usize| rows[axis * count..].first_chunk().expect("rows of the right length");
        [simd.load(row(0)), simd.load(row(1)), simd.load(row(2))]
    }

    /// Of the lanes of a leaf, those that f32 cannot reject.
    // Written out, axis by axis: closures and iterators between here and the kernel's entry are not always compiled for
    // its level, and then every operation is a call.
    #[inline(always)]
    fn not_rejected<S: Simd<N>>(&self, simd: S, ray: &BlockRay, first: usize, count: u32, edges: bool) -> u32 {
        let o = [simd.splat(ray.origin[0]), simd.splat(ray.origin[1]), simd.splat(ray.origin[2])];
        let d = [simd.splat(ray.direction[0]), simd.splat(ray.direction[1]), simd.splat(ray.direction[2])];
        let a = self.numbers(simd, first, count, 0);
        let mut e = self.numbers(simd, first, count, 1);
        let mut f = self.numbers(simd, first, count, 2);
        if !edges {
            (e, f) = (difference(simd, e, a), difference(simd, f, a));
        }
        not_rejected(simd, [a, e, f], o, d, &ray.errors) & ((1 << count) - 1)
    }

    /// Of sixteen rays, those for which f32 cannot reject the triangle in a lane of a leaf.
    #[inline(always)]
    fn rays_not_rejected<S: Simd<N>>(
        &self,
        simd: S,
        rays: &BlockRays,
        first: usize,
        count: u32,
        lane: usize,
        edges: bool,
    ) -> u32 {
        let [a, mut e, mut f] = self.vectors(first, count, lane);
        if !edges {
            (e, f) = (e - a, f - a);
        }
        let a = [simd.splat(a.x), simd.splat(a.y), simd.splat(a.z)];
        let e = [simd.splat(e.x), simd.splat(e.y), simd.splat(e.z)];
        let f = [simd.splat(f.x), simd.splat(f.y), simd.splat(f.z)];
        let mut left = 0;
        for part in 0..RAYS / N {
            let (o, d) = (&rays.origin, &rays.direction);
            let o = [part_of(simd, &o[0], part), part_of(simd, &o[1], part), part_of(simd, &o[2], part)];
            let d = [part_of(simd, &d[0], part), part_of(simd, &d[1], part), part_of(simd, &d[2], part)];
            left |= (not_rejected(simd, [a, e, f], o, d, &rays.errors) & ((1 << N) - 1)) << (part * N);
        }
        left
    }
}

/// One vector of a column.
#[inline(always)]
fn part_of<const N: usize, S: Simd<N>>(simd: S, column: &Column<f32>, part: usize) -> S::F32 {
    simd.load(&column.as_chunks::<N>().0[part])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Ray;
    use crate::simd::{Dispatch, Kernel, Level};
    use proptest::prelude::*;

    /// What is not rejected of one leaf.
    struct Left<'a, L> {
        leaves: &'a L,
        ray: &'a BlockRay,
        count: u32,
    }

    impl<const N: usize, L: Leaves<N>> Kernel<N> for Left<'_, L> {
        type Output = u32;

        #[inline(always)]
        fn run<S: Simd<N>>(self, simd: S) -> u32 {
            self.leaves.not_rejected(simd, self.ray, 0, self.count)
        }
    }

    /// Those with so many lanes.
    fn levels<const N: usize>() -> impl Iterator<Item = Level> {
        Level::ALL.into_iter().filter(|l| l.is_available() && l.lanes() >= N)
    }

    /// Nothing that is met may be rejected.
    fn nothing_met_is_rejected<const N: usize, L: Leaves<N>>(
        ray: &Ray,
        triangles: &[[DVec3; 3]],
    ) -> Result<usize, TestCaseError>
    where
        Level: Dispatch<N>,
    {
        let region = Region::around(triangles.iter().flatten().copied());
        let order: Vec<u32> = (0..triangles.len() as u32).collect();
        let leaves = L::new(&region, &order, &[triangles.len() as u32], |p| triangles[p as usize]);
        let Some(edges) = EdgeRay::new(ray, &region) else { return Ok(0) };
        let lanes = L::ray(&edges, &region);
        let met: Vec<_> = triangles.iter().map(|&t| edges.meet(t).is_some()).collect();
        for level in levels::<N>() {
            let left = level.dispatch(Left { leaves: &leaves, ray: &lanes, count: triangles.len() as u32 });
            prop_assert_eq!(left >> triangles.len(), 0);
            for (lane, &met) in met.iter().enumerate() {
                prop_assert!(!met || left >> lane & 1 == 1, "{:?} rejects {:?} of {:?}", level, triangles[lane], ray);
            }
        }
        Ok(met.iter().filter(|&&m| m).count())
    }

    fn point(size: f64) -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-size..size).prop_map(DVec3::from_array)
    }

    /// A triangle of any shape and size, somewhere, and a ray to a point of it: within, or as near to an edge, a corner or
    /// the ray's start as roundings are.
    fn aimed() -> impl Strategy<Value = (Ray, [DVec3; 3])> {
        let triangle = (point(1.0), [point(1.0), point(1.0), point(1.0)], 0i32..24, 0i32..24);
        let weights = (0.0..1.0f64, 0.0..1.0f64, -30i32..2, prop::bool::ANY);
        let ray = (point(1.0), -26i32..10, -30i32..30, -20i32..20);
        (triangle, weights, ray).prop_map(
            |((at, ways, small, thin), (v, w, edge, before), (way, far, length, scale))| {
                let mut corners = ways.map(|way| at + way * 2f64.powi(-small));
                corners[2] = corners[1] + (corners[2] - corners[1]) * 2f64.powi(-thin);
                let corners = corners.map(|c| (c * 2f64.powi(scale)).as_vec3().as_dvec3());
                let (v, w) = (v * 2f64.powi(edge.min(0)), w * (1.0 - v));
                let target = corners[0] * (1.0 - v - w) + corners[1] * v + corners[2] * w;
                let back = way * 2f64.powi(far + scale) * if before { 1.0 } else { 2f64.powi(-24) };
                let origin = target - back;
                (Ray::new(origin, (target - origin) * 2f64.powi(length)), corners)
            },
        )
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]
        #[test]
        fn the_test_in_f32_rejects_nothing_that_is_met(
            (ray, triangle) in aimed(), others in prop::collection::vec(aimed(), 0..4), at in 0usize..5, off in -30i32..30
        ) {
            let mut triangles: Vec<_> = others.iter().map(|(_, t)| *t).collect();
            triangles.insert(at.min(others.len()), triangle);
            nothing_met_is_rejected::<4, SingleLeaves<4>>(&ray, &triangles)?;
            nothing_met_is_rejected::<4, DoubleLeaves<4>>(&ray, &triangles)?;
            nothing_met_is_rejected::<8, SingleLeaves<8>>(&ray, &triangles)?;
            nothing_met_is_rejected::<8, DoubleLeaves<8>>(&ray, &triangles)?;
            let moved = DVec3::new(1.0, -0.7, 0.3) * 2f64.powi(off);
            let ray = Ray { origin: ray.origin + moved, ..ray };
            let triangles: Vec<_> = triangles.iter().map(|t| t.map(|c| c + moved)).collect();
            nothing_met_is_rejected::<4, DoubleLeaves<4>>(&ray, &triangles)?;
            nothing_met_is_rejected::<8, DoubleLeaves<8>>(&ray, &triangles)?;
        }
    }

    #[test]
    fn most_of_what_is_not_met_is_rejected() {
        let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let region = Region::around(triangle);
        let four = SingleLeaves::<4>::new(&region, &[7], &[1], |_| triangle);
        let eight = SingleLeaves::<8>::new(&region, &[7], &[1], |_| triangle);
        let left = |origin: DVec3, direction: DVec3| {
            let edges = EdgeRay::new(&Ray::new(origin, direction), &region).unwrap();
            let ray = &<SingleLeaves<8> as Leaves<8>>::ray(&edges, &region);
            let narrow = levels::<4>().map(|level| level.dispatch(Left { leaves: &four, ray, count: 1 }));
            let wide = levels::<8>().map(|level| level.dispatch(Left { leaves: &eight, ray, count: 1 }));
            let found: Vec<_> = narrow.chain(wide).collect();
            assert!(found.iter().all(|&f| f == found[0]), "{found:?}");
            found[0] == 1
        };
        let above = DVec3::new(0.25, 0.25, 1.0);
        assert!(left(above, -DVec3::Z));
        assert!(!left(above, DVec3::Z), "behind");
        assert!(!left(above + DVec3::X * 0.51, -DVec3::Z), "beside");
        assert!(!left(above - DVec3::Y * 0.26, -DVec3::Z), "beside");
    }
}
