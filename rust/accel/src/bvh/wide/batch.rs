//! A batch of rays for one tree, by the kernel that suits them.

use super::answer::Answer;
use super::errand::{Errand, Telling};
use super::first::First;
use super::winners::{Alone, Winners};
use super::{WideBvh, few, packet, single, wave};
use crate::query::Query;
use raywright_base::math::{RayBatch, coherence};
use raywright_base::simd::{Kernel, Simd};
use raywright_shapes::triangle::Leaves;

/// Fewer rays than these leave a packet or a wave mostly empty.
const FEW: usize = 8;

struct Width<const N: usize>;

impl<const N: usize> Width<N> {
    /// On x86-64, kernels of four lanes serve processors that lack AVX2: only the single-ray kernel is compiled for them.
    const SINGLE_RAYS_ONLY: bool = N == 4 && cfg!(target_arch = "x86_64");
}

/// A question about all that a batch of rays meets.
pub struct All<'a, const N: usize, L, Q> {
    pub bvh: &'a WideBvh<N, L>,
    pub rays: RayBatch<'a>,
    pub query: &'a mut Q,
}

impl<const N: usize, L: Leaves<N>, Q: Query> Kernel<N> for All<'_, N, L, Q> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd<N>>(self, simd: S) {
        let Self { bvh, rays, query } = self;
        let errand = &mut Telling { rays: &rays, query };
        if bvh.nodes.is_empty() {
            miss(bvh, rays.len(), errand);
        } else if Width::<N>::SINGLE_RAYS_ONLY || Q::COUNTED || rays.len() < FEW {
            single::answer(simd, bvh, &rays, errand);
        } else {
            wave::answer(simd, bvh, &rays, errand);
        }
    }
}

/// The first hits of a batch of rays, or whether they have any.
pub struct Firsts<'a, const N: usize, L, A> {
    pub bvh: &'a WideBvh<N, L>,
    pub rays: RayBatch<'a>,
    pub answer: A,
}

impl<const N: usize, L: Leaves<N>, A: Answer> Kernel<N> for Firsts<'_, N, L, A> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd<N>>(self, simd: S) {
        let Self { bvh, rays, mut answer } = self;
        if Width::<N>::SINGLE_RAYS_ONLY || rays.len() == 1 {
            let errand = &mut First { rays: &rays, answer: &mut answer, winners: Alone };
            return if bvh.nodes.is_empty() {
                miss(bvh, rays.len(), errand);
            } else {
                single::answer(simd, bvh, &rays, errand);
            };
        }
        let errand = &mut First { rays: &rays, answer: &mut answer, winners: Winners::new() };
        if bvh.nodes.is_empty() {
            miss(bvh, rays.len(), errand);
        } else if rays.len() < FEW {
            single::answer(simd, bvh, &rays, errand);
        } else if let Some(leaves) = few::leaves(bvh) {
            few::answer(simd, bvh, &leaves, errand);
        } else if is_coherent(bvh, rays) {
            packet::answer(simd, bvh, errand);
        } else {
            // Scattered rays sorted by octant, so that packets would take them, are slower as soon as a tree has two
            // nodes.
            wave::answer(simd, bvh, &rays, errand);
        }
    }
}

/// Whether packets suit rays.
#[inline(always)]
fn is_coherent<const N: usize, L>(bvh: &WideBvh<N, L>, rays: RayBatch<'_>) -> bool {
    let ray = |i: usize| {
        let ray = rays.get(i);
        (ray.origin, ray.direction)
    };
    coherence::is_coherent(rays.len(), ray, bvh.region.radius)
}

/// Says that no ray hits anything.
#[inline(always)]
fn miss<const N: usize, L: Leaves<N>, E: Errand<N, L>>(_: &WideBvh<N, L>, rays: usize, errand: &mut E) {
    for i in 0..rays {
        errand.miss(i);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::Options;
    use crate::{BruteForce, Primitives};
    use raywright_base::math::{DVec3, Hit, HitColumns, Numbers, Ray, RayColumns, Vec3, Vectors};
    use raywright_base::sampling::philox4x32;
    use raywright_base::simd::{Dispatch, Level, Scalar};
    use raywright_shapes::triangle::{DoubleLeaves, SingleLeaves};

    struct Soup(Vec<[Vec3; 3]>);

    impl Primitives for Soup {
        fn count(&self) -> usize {
            self.0.len()
        }
        fn corners(&self, primitive: u32) -> [DVec3; 3] {
            self.0[primitive as usize].map(Vec3::as_dvec3)
        }
        fn is_single(&self) -> bool {
            true
        }
    }

    /// The `i`-th of any number of triples from −1 to 1.
    fn triple(i: u32) -> DVec3 {
        let [x, y, z, _] = philox4x32([i, 0, 0, 0], [7, 7]).map(|bits| f64::from(bits) / f64::from(1u32 << 31) - 1.0);
        DVec3::new(x, y, z)
    }

    /// Triangles of all sizes, with a few planes through them so that rays meet edges and ties.
    fn soup() -> Soup {
        let corner = |i: u32, size: f64| (triple(i) + size * triple(i + 10_000)).as_vec3();
        let mut all: Vec<_> = (0..1000)
            .map(|i| {
                let size = 0.3 * triple(i + 20_000).x.powi(4);
                [0, 1, 2].map(|k| (triple(i) + size * triple(3 * i + k + 30_000)).as_vec3())
            })
            .collect();
        all.extend((0..20).map(|i| [corner(i, 0.5), corner(i, 0.5), corner(i + 1, 0.5)]));
        for (x, y) in (-8..8).flat_map(|x| (-8..8).map(move |y| (x as f32 / 8.0, y as f32 / 8.0))) {
            let [a, b, c, d] =
                [(0.0, 0.0), (0.125, 0.0), (0.125, 0.125), (0.0, 0.125)].map(|(u, v)| Vec3::new(x + u, y + v, 0.25));
            all.extend([[a, b, c], [a, c, d], [a, c, d]]);
        }
        Soup(all)
    }

    /// Fans of neighbouring rays: through the pixels of cameras near and far, parallel ones along axes, and with gaps
    /// of rays that cannot hit anything.
    fn fans() -> Vec<Vec<Ray>> {
        let mut fans = Vec::new();
        for camera in 0..12 {
            let distance = [0.0, 0.5, 3.0, 7.0, 100.0, 1e6][camera as usize % 6];
            let eye = triple(camera + 50_000).normalize() * distance;
            let at = 0.3 * triple(camera + 60_000);
            let spread = if distance > 0.0 { 1.0 / distance } else { 0.7 };
            let fan = (0..640u32).map(|i| {
                let (x, y) = (f64::from(i % 40) / 20.0 - 1.0, f64::from(i / 40) / 8.0 - 1.0);
                let forward = (at - eye).normalize();
                let side = forward.any_orthonormal_vector();
                let direction = forward + spread * (x * side + y * forward.cross(side));
                if i % 53 == 7 {
                    Ray::new(eye, DVec3::NAN)
                } else {
                    Ray::new(eye, direction * 10f64.powi(i as i32 % 5))
                }
            });
            fans.push(fan.collect());
        }
        for axis in [DVec3::Z, -DVec3::Z, DVec3::X, DVec3::new(1.0, 1.0, 0.0)] {
            let side = axis.normalize().any_orthonormal_vector();
            let up = axis.normalize().cross(side);
            let grid = (0..640u32).map(|i| {
                let (x, y) = (f64::from(i % 32) / 16.0 - 1.0, f64::from(i / 32) / 16.0 - 0.5);
                let mut ray = Ray::new(-3.0 * axis + side * x + up * y, axis);
                ray.t_max = if i % 3 == 0 { f64::INFINITY } else { 3.25 };
                ray
            });
            fans.push(grid.collect());
        }
        fans
    }

    /// Which kernel to run.
    #[derive(Clone, Copy, Debug)]
    enum Which {
        Single,
        Wave,
        Packet,
        Few,
    }

    struct By<'a, const N: usize, L, A> {
        which: Which,
        asked: Firsts<'a, N, L, A>,
    }

    impl<const N: usize, L: Leaves<N>, A: Answer> Kernel<N> for By<'_, N, L, A> {
        type Output = ();

        #[inline(always)]
        fn run<S: Simd<N>>(self, simd: S) {
            let Firsts { bvh, rays, mut answer } = self.asked;
            let errand = &mut First { rays: &rays, answer: &mut answer, winners: Winners::new() };
            match self.which {
                Which::Single => single::answer(simd, bvh, &rays, errand),
                Which::Wave => wave::answer(simd, bvh, &rays, errand),
                Which::Packet => packet::answer(simd, bvh, errand),
                Which::Few => few::answer(simd, bvh, &few::leaves(bvh).expect("few triangles"), errand),
            }
        }
    }

    /// Runs a kernel at a level. Levels of four lanes run what batches run; all kernels of four lanes run as arrays.
    fn run<const N: usize, L: Leaves<N>, A: Answer>(level: Level, by: By<'_, N, L, A>)
    where
        Level: Dispatch<N>,
        Scalar: Simd<N>,
    {
        if N == Level::Scalar.lanes() {
            if level == Level::Scalar {
                by.run(Scalar);
            } else {
                level.dispatch(by.asked);
            }
        } else {
            level.dispatch(by);
        }
    }

    fn kernels_agree<const N: usize>()
    where
        Level: Dispatch<N>,
        Scalar: Simd<N>,
    {
        // Many; and few: large ones, and a part of the planes.
        let Soup(all) = soup();
        let large = |i: u32| [0, 1, 2].map(|k| (1.2 * triple(3 * i + k + 70_000)).as_vec3());
        let few: Vec<_> = (0..12).map(large).collect();
        for some in [&all[..], &few[..1], &few, &all[all.len() - 64..]] {
            let soup = Soup(some.to_vec());
            kernels_agree_over::<N, SingleLeaves<N>>(&soup, false);
            kernels_agree_over::<N, DoubleLeaves<N>>(&soup, false);
        }
        kernels_agree_over::<N, SingleLeaves<N>>(&sticks(), true);
        kernels_agree_over::<N, DoubleLeaves<N>>(&sticks(), true);
    }

    /// Long thin triangles along axes of their own, and in planes at right angles to these.
    fn sticks() -> Soup {
        let x = DVec3::new(0.48, 0.64, 0.6);
        let axes = [x, x.any_orthonormal_vector(), x.cross(x.any_orthonormal_vector())];
        let stick = |i: u32| {
            let (from, way) = (triple(i), i as usize % 3);
            [from, from + axes[way], from + 0.02 * axes[(way + 1) % 3]].map(DVec3::as_vec3)
        };
        Soup((0..600).map(stick).collect())
    }

    fn kernels_agree_over<const N: usize, L: Leaves<N>>(soup: &Soup, is_turned: bool)
    where
        Level: Dispatch<N>,
        Scalar: Simd<N>,
    {
        let is_few = soup.0.len() <= few::TRIANGLES;
        let kernels = [Which::Single, Which::Wave, Which::Packet, Which::Few];
        let kernels = if is_few { &kernels[..] } else { &kernels[..3] };
        let is_tested = |level: &Level| level.lanes() >= N && (*level == Level::Scalar || level.is_available());
        for level in Level::ALL.into_iter().filter(is_tested) {
            let brute = BruteForce::over(soup, level);
            let bvh = WideBvh::<N, L>::new(soup, &Options::DEFAULT, level);
            assert_eq!(bvh.axes.is_some(), is_turned);
            let mut met = 0;
            for rays in fans() {
                let mut wanted = vec![Hit::MISS; rays.len()];
                brute.intersect(&rays, &mut wanted);
                let hits = wanted.iter().filter(|h| h.is_hit()).count();
                assert!(is_few || hits > 50, "a fan that misses shows nothing");
                met += hits;
                for &which in kernels {
                    let mut hits = vec![Hit::MISS; rays.len()];
                    let rays = RayBatch::Rows(&rays);
                    run(level, By { which, asked: Firsts { bvh: &bvh, rays, answer: hits.as_mut_slice() } });
                    assert_eq!(hits, wanted, "{which:?} at {level:?}");
                    let mut any = vec![false; rays.len()];
                    run(level, By { which, asked: Firsts { bvh: &bvh, rays, answer: any.as_mut_slice() } });
                    assert!(any.iter().zip(&wanted).all(|(&any, hit)| any == hit.is_hit()), "{which:?} at {level:?}");
                }
            }
            assert!(met > 100, "{met} rays hit anything");
        }
    }

    /// Rays by columns; f32 if they are.
    fn by_columns(rays: &[Ray], single: bool, ask: impl FnOnce(&RayColumns<'_>)) {
        let column = |of: fn(&Ray) -> f64| rays.iter().map(of).collect::<Vec<f64>>();
        let origin = [column(|r| r.origin.x), column(|r| r.origin.y), column(|r| r.origin.z)];
        let direction = [column(|r| r.direction.x), column(|r| r.direction.y), column(|r| r.direction.z)];
        let (t_min, t_max) = (column(|r| r.t_min), column(|r| r.t_max));
        let small =
            |columns: &[Vec<f64>; 3]| columns.each_ref().map(|c| c.iter().map(|&x| x as f32).collect::<Vec<_>>());
        let (small_origin, small_direction) = (small(&origin), small(&direction));
        let (origin, direction) = if single {
            (
                Vectors::Single(small_origin.each_ref().map(Vec::as_slice)),
                Vectors::Single(small_direction.each_ref().map(Vec::as_slice)),
            )
        } else {
            (
                Vectors::Double(origin.each_ref().map(Vec::as_slice)),
                Vectors::Double(direction.each_ref().map(Vec::as_slice)),
            )
        };
        ask(&RayColumns::new(origin, direction, Numbers::Each(&t_min), Numbers::Each(&t_max)));
    }

    #[test]
    fn rays_by_columns_are_answered_as_the_same_rays_one_after_the_other() {
        let soup = soup();
        for level in Level::ALL.into_iter().filter(|l| l.is_available()) {
            let tree = crate::bvh::widest(&soup, &Options::DEFAULT, level);
            let columns = tree.by_columns().expect("a tree over triangles");
            for (which, mut rays) in fans().into_iter().enumerate() {
                let single = which % 2 == 1;
                if single {
                    for ray in &mut rays {
                        (ray.origin, ray.direction) =
                            (ray.origin.as_vec3().as_dvec3(), ray.direction.as_vec3().as_dvec3());
                    }
                }
                // Scattered too, and of every number that leaves another rest.
                if which % 3 == 2 {
                    rays.sort_by_key(|r| (r.direction.x.to_bits() ^ r.origin.y.to_bits()).wrapping_mul(0x9e37_79b9));
                }
                rays.truncate(640 - 37 * which);
                let mut wanted = vec![Hit::MISS; rays.len()];
                tree.intersect(&rays, &mut wanted);
                let (mut t, mut uv, mut primitive) =
                    (vec![0.0; rays.len()], vec![[0.0; 2]; rays.len()], vec![0; rays.len()]);
                let mut any = vec![false; rays.len()];
                by_columns(&rays, single, |rays| {
                    let hits = HitColumns { t: &mut t, uv: &mut uv, primitive: &mut primitive };
                    columns.intersect(rays, hits);
                    columns.occluded(rays, &mut any);
                });
                for (i, hit) in wanted.iter().enumerate() {
                    assert_eq!((t[i], uv[i], primitive[i]), (hit.t, hit.uv, hit.primitive as i32), "{:?}", rays[i]);
                    assert_eq!(any[i], hit.is_hit());
                }
            }
        }
    }

    #[test]
    fn kernels_four_wide_agree_with_brute_force_bit_for_bit() {
        kernels_agree::<4>();
    }

    #[test]
    fn kernels_eight_wide_agree_with_brute_force_bit_for_bit() {
        kernels_agree::<8>();
    }
}
