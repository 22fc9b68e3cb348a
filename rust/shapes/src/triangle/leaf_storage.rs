//! Leaf storage of triangles with f32 or f64 corners.

use super::leaf_rows::Rows;
use super::leaves::Leaves;
use super::pretest::{BlockRay, BlockRays};
use super::{EdgeRay, PlainRays, RAYS};
use raywright_base::math::{DVec3, Region};
use raywright_base::parallel;
use raywright_base::simd::Lanes;

/// Triangles with f32 coordinates.
#[derive(Clone, Debug)]
pub struct SingleLeaves<const N: usize> {
    rows: Rows<N>,
}

/// Triangles with f64 coordinates: rounded for the pretest, and in full precision.
#[derive(Clone, Debug)]
pub struct DoubleLeaves<const N: usize> {
    /// In box units.
    rows: Rows<N>,
    corners: Vec<[DVec3; 3]>,
}

impl<const N: usize> Leaves<N> for SingleLeaves<N> {
    const PRECISION: &'static str = "single";
    type Real = f32;
    const EDGES: bool = false;

    fn new(_: &Region, order: &[u32], counts: &[u32], corners: impl Fn(u32) -> [DVec3; 3] + Sync) -> Self {
        // Exact, since the coordinates are f32.
        Self { rows: Rows::new(order, counts, |p| corners(p).map(|c| c.as_vec3())) }
    }

    #[inline(always)]
    fn rows(&self) -> &Rows<N> {
        &self.rows
    }

    #[inline(always)]
    fn corners(&self, first: usize, count: u32, lane: usize) -> [DVec3; 3] {
        // Written out, since `map` is not always compiled for a kernel's SIMD level.
        let [a, b, c] = self.rows.vectors(first, count, lane);
        [a.as_dvec3(), b.as_dvec3(), c.as_dvec3()]
    }

    #[inline(always)]
    fn coordinates(&self, first: usize, count: u32, lane: usize) -> [[f32; 3]; 3] {
        let [a, b, c] = self.rows.vectors(first, count, lane);
        [a.to_array(), b.to_array(), c.to_array()]
    }

    #[inline(always)]
    fn ray(ray: &EdgeRay, _: &Region) -> BlockRay {
        BlockRay::new(ray.origin, ray, ray.absolute)
    }

    #[inline(always)]
    fn take<S: Lanes<RAYS>>(simd: S, rays: &PlainRays, region: &Region, to: &mut BlockRays) {
        to.take(simd, &rays.origin, rays, rays.absolute(simd, region));
    }

    #[inline(always)]
    fn unit(_: &Region) -> f64 {
        1.0
    }

    fn bytes(&self) -> usize {
        self.rows.bytes()
    }
}

impl<const N: usize> Leaves<N> for DoubleLeaves<N> {
    const PRECISION: &'static str = "double";
    type Real = f64;
    const EDGES: bool = true;

    fn new(region: &Region, order: &[u32], counts: &[u32], corners: impl Fn(u32) -> [DVec3; 3] + Sync) -> Self {
        let rows = Rows::new(order, counts, |p| {
            let [a, b, c] = corners(p);
            [region.to_box(a).as_vec3(), ((b - a) * region.scale).as_vec3(), ((c - a) * region.scale).as_vec3()]
        });
        Self { rows, corners: parallel::collect(order.len(), |i| corners(order[i])) }
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
    fn coordinates(&self, first: usize, _: u32, lane: usize) -> [[f64; 3]; 3] {
        let [a, b, c] = self.corners[first + lane];
        [a.to_array(), b.to_array(), c.to_array()]
    }

    #[inline(always)]
    fn ray(ray: &EdgeRay, region: &Region) -> BlockRay {
        // |origin| + |corner|, both relative to the center and in box units.
        BlockRay::new(ray.local * region.scale, ray, ray.largest * region.scale)
    }

    #[inline(always)]
    fn take<S: Lanes<RAYS>>(simd: S, rays: &PlainRays, _: &Region, to: &mut BlockRays) {
        to.take(simd, &rays.local, rays, rays.most(simd));
    }

    #[inline(always)]
    fn unit(region: &Region) -> f64 {
        region.scale
    }

    fn bytes(&self) -> usize {
        self.rows.bytes() + size_of_val(self.corners.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use raywright_base::math::Ray;
    use raywright_base::simd::{Dispatch, Kernel, Level, Simd};

    /// Collects the triangles of one leaf that the pretest does not reject.
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

    /// The available SIMD levels with at least N lanes.
    fn levels<const N: usize>() -> impl Iterator<Item = Level> {
        Level::ALL.into_iter().filter(|l| l.is_available() && l.lanes() >= N)
    }

    /// Assert that no hit triangle is rejected.
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

    /// A triangle of any shape, size and position, and a ray to a point in it: inside, or within roundings of an edge,
    /// a corner or the ray's start.
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
            (ray, triangle) in aimed(), others in prop::collection::vec(aimed(), 0..4),
            at in 0usize..5, off in -30i32..30,
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
