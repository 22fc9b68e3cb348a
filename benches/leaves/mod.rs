//! Leaves of triangles and their tests.

use raywright::math::{DVec3, Ray, Region};
use raywright::shapes::triangle::{BlockRay, EdgeRay, Leaves, SingleLeaves};
use raywright::simd::{Dispatch, Kernel, Level, Simd};

/// Leaves of equal size, with a ray for each.
pub struct Full<const N: usize> {
    leaves: SingleLeaves<N>,
    count: u32,
    rays: Vec<(BlockRay, EdgeRay)>,
}

/// Number of leaves, few enough to stay in the cache.
const SOME: usize = 64;

impl<const N: usize> Full<N>
where
    Level: Dispatch<N>,
{
    /// Make leaves of `count` adjacent triangles. Each ray hits one triangle of its leaf, or misses them all.
    pub fn new(count: u32, meets: bool) -> Self {
        let width = count as usize;
        // A triangle of size 1 at each integer, slightly rotated, so that no edge is axis-aligned.
        let corners = |p: u32| {
            let at = DVec3::new(f64::from(p % count), f64::from(p / count), 0.0);
            [[0.0, 0.0, 0.25], [0.75, 0.125, 0.0], [0.25, 0.75, 0.5]].map(|c| at + DVec3::from_array(c))
        };
        let order: Vec<u32> = (0..count * SOME as u32).collect();
        let region = Region::around(order.iter().flat_map(|&p| corners(p)));
        let leaves = <SingleLeaves<N> as Leaves<N>>::new(&region, &order, &[count; SOME], corners);
        let rays = (0..SOME).map(|i| {
            let [a, b, c] = corners((i * width + i % width) as u32);
            let target = (a + b + c) / 3.0 + if meets { DVec3::ZERO } else { DVec3::X * 100.0 };
            let origin = DVec3::new(1.5 - i as f64 / SOME as f64, 7.0, -5.0);
            let edges = EdgeRay::new(&Ray::new(origin, target - origin), &region).expect("a ray that can hit");
            (<SingleLeaves<N> as Leaves<N>>::ray(&edges, &region), edges)
        });
        let rays = rays.collect();
        let full = Self { leaves, count, rays };
        for level in Level::ALL.into_iter().filter(|l| l.is_available() && l.lanes() >= N) {
            let wanted = if meets { SOME as u32 } else { 0 };
            assert_eq!(full.left(level), wanted, "triangles that f32 leaves over at {}", level.name());
            assert_eq!(full.met(level), wanted, "triangles that are met at {}", level.name());
        }
        full
    }

    /// Return the number of leaves.
    pub fn len(&self) -> usize {
        SOME
    }

    /// Return the number of triangles that the f32 test leaves undecided, each leaf with its ray.
    pub fn left(&self, level: Level) -> u32 {
        level.dispatch(Left(self))
    }

    /// Return the number of hits: the f32 test, and f64 for undecided triangles.
    pub fn met(&self, level: Level) -> u32 {
        level.dispatch(Met(self))
    }
}

struct Left<'a, const N: usize>(&'a Full<N>);

impl<const N: usize> Kernel<N> for Left<'_, N> {
    type Output = u32;

    #[inline(always)]
    fn run<S: Simd<N>>(self, simd: S) -> u32 {
        let Full { leaves, count, rays } = self.0;
        let mut left = 0;
        for (i, (ray, _)) in rays.iter().enumerate() {
            left += leaves.not_rejected(simd, ray, i * *count as usize, *count).count_ones();
        }
        left
    }
}

struct Met<'a, const N: usize>(&'a Full<N>);

impl<const N: usize> Kernel<N> for Met<'_, N> {
    type Output = u32;

    #[inline(always)]
    fn run<S: Simd<N>>(self, simd: S) -> u32 {
        let Full { leaves, count, rays } = self.0;
        let mut met = 0;
        for (i, (ray, edges)) in rays.iter().enumerate() {
            let first = i * *count as usize;
            let mut left = leaves.not_rejected(simd, ray, first, *count);
            while left != 0 {
                let lane = left.trailing_zeros() as usize & (N - 1);
                left &= left - 1;
                met += u32::from(edges.meet(leaves.corners(first, *count, lane)).is_some());
            }
        }
        met
    }
}
