//! Chooses the kernel for a batch of rays.

use super::first::First;
use super::hit_sink::Answer;
use super::leaf_visitor::{Errand, QueryVisitor};
use super::refine_hits::{Alone, Winners};
use super::{WideBvh, few_leaves, packet, single, wave};
use crate::query::Query;
use raywright_base::math::{RayBatch, coherence};
use raywright_base::simd::{Kernel, Simd};
use raywright_shapes::triangle::Leaves;

/// Fewer rays than this leave a packet or a wave mostly empty.
const FEW: usize = 8;

struct Width<const N: usize>;

impl<const N: usize> Width<N> {
    /// On x86-64, four lanes serve processors without AVX2; only the single-ray kernel is compiled for them.
    const SINGLE_RAYS_ONLY: bool = N == 4 && cfg!(target_arch = "x86_64");
}

/// A query for all intersections of a batch of rays.
pub struct All<'a, const N: usize, L, Q> {
    pub bvh: &'a WideBvh<N, L>,
    pub rays: RayBatch<'a>,
    pub query: &'a mut Q,
}

impl<const N: usize, L: Leaves<N>, Q: Query> Kernel<N> for All<'_, N, L, Q> {
    type Output = ();
    const AVX512: bool = false;

    #[inline(always)]
    fn run<S: Simd<N>>(self, simd: S) {
        let Self { bvh, rays, query } = self;
        let errand = &mut QueryVisitor { rays: &rays, query };
        if bvh.nodes.is_empty() {
            miss(bvh, rays.len(), errand);
        } else if Width::<N>::SINGLE_RAYS_ONLY || Q::COUNTED || rays.len() < FEW {
            single::answer(simd, bvh, &rays, errand);
        } else {
            wave::answer(simd, bvh, &rays, errand);
        }
    }
}

/// First-hit or occlusion queries for a batch of rays.
pub struct Firsts<'a, const N: usize, L, A> {
    pub bvh: &'a WideBvh<N, L>,
    pub rays: RayBatch<'a>,
    pub answer: A,
}

impl<const N: usize, L: Leaves<N>, A: Answer> Kernel<N> for Firsts<'_, N, L, A> {
    type Output = ();
    // The crate's own tests would compile all kernels again; the tests of the Python interface run them at every level.
    const AVX512: bool = cfg!(not(test));

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
        } else if let Some(leaves) = few_leaves::leaves(bvh) {
            few_leaves::answer(simd, bvh, &leaves, errand);
        } else if is_coherent(bvh, rays) {
            packet::answer(simd, bvh, errand);
        } else {
            // Sorting incoherent rays by octant for packets is slower for any tree of more than one node.
            wave::answer(simd, bvh, &rays, errand);
        }
    }
}

/// Return whether packets suit the rays.
#[inline(always)]
fn is_coherent<const N: usize, L>(bvh: &WideBvh<N, L>, rays: RayBatch<'_>) -> bool {
    let ray = |i: usize| {
        let ray = rays.get(i);
        (ray.origin, ray.direction)
    };
    coherence::is_coherent(rays.len(), ray, bvh.region.radius)
}

/// Report a miss for every ray.
#[inline(always)]
fn miss<const N: usize, L: Leaves<N>, E: Errand<N, L>>(_: &WideBvh<N, L>, rays: usize, errand: &mut E) {
    for i in 0..rays {
        errand.miss(i);
    }
}

#[cfg(test)]
mod tests {
    use super::super::hit_sink::Closest;
    use super::*;
    use crate::BruteForce;
    use crate::bvh::Options;
    use crate::fans::{Soup, fans, soups, sticks};
    use raywright_base::math::{Hit, Ray};
    use raywright_base::simd::{Level, Scalar};
    use raywright_shapes::triangle::{DoubleLeaves, SingleLeaves};

    /// A kernel, named explicitly since batches of four lanes use only single rays on x86-64.
    #[derive(Clone, Copy, Debug)]
    enum Which {
        Single,
        Wave,
        Packet,
        Few,
    }

    fn run<L: Leaves<4>, A: Answer>(which: Which, firsts: Firsts<'_, 4, L, A>) {
        let Firsts { bvh, rays, mut answer } = firsts;
        let errand = &mut First { rays: &rays, answer: &mut answer, winners: Winners::new() };
        match which {
            Which::Single => single::answer(Scalar, bvh, &rays, errand),
            Which::Wave => wave::answer(Scalar, bvh, &rays, errand),
            Which::Packet => packet::answer(Scalar, bvh, errand),
            Which::Few => few_leaves::answer(Scalar, bvh, &few_leaves::leaves(bvh).expect("few triangles"), errand),
        }
    }

    /// Run `agree` for each kernel with a tree, rays, and their hits by brute force.
    fn kernels_agree<L: Leaves<4>>(
        soup: &Soup,
        is_turned: bool,
        agree: impl Fn(Which, &WideBvh<4, L>, RayBatch, &[Hit]),
    ) {
        let kernels = [Which::Single, Which::Wave, Which::Packet, Which::Few];
        let is_few = soup.triangles.len() <= few_leaves::TRIANGLES;
        let level = Level::current().unwrap();
        let brute = BruteForce::over(soup, level);
        let bvh = WideBvh::<4, L>::new(soup, &Options::DEFAULT, level);
        assert_eq!(bvh.axes.is_some(), is_turned);
        let mut met = 0;
        for rays in fans() {
            let mut wanted = vec![Hit::MISS; rays.len()];
            brute.intersect(&rays, &mut wanted);
            let hits = wanted.iter().filter(|h| h.is_hit()).count();
            assert!(is_few || hits > 50, "a fan that misses shows nothing");
            met += hits;
            for &which in if is_few { &kernels[..] } else { &kernels[..3] } {
                agree(which, &bvh, RayBatch::Rows(&rays), &wanted);
            }
        }
        assert!(met > 100, "{met} rays hit anything");
    }

    // Kernels are generic over leaves and outputs independently: two combinations cover both, and compile in half of
    // the time.
    #[test]
    fn kernels_of_four_lanes_as_arrays_agree_with_brute_force_bit_for_bit() {
        for (triangles, is_turned) in soups().into_iter().map(|soup| (soup, false)).chain([(sticks(), true)]) {
            let soup = Soup { triangles, is_single: true };
            kernels_agree::<SingleLeaves<4>>(&soup, is_turned, |which, bvh, rays, wanted| {
                let mut hits = vec![Hit::MISS; wanted.len()];
                run(which, Firsts { bvh, rays, answer: Closest::Rows(&mut hits) });
                assert_eq!(hits, wanted, "{which:?}");
                let mut primitives = vec![0; wanted.len()];
                run(which, Firsts { bvh, rays, answer: Closest::Primitives(&mut primitives) });
                let of = |hit: &Hit| if hit.is_hit() { hit.primitive } else { Ray::NO_TRIANGLE };
                assert!(primitives.iter().zip(wanted).all(|(&primitive, hit)| primitive == of(hit)), "{which:?}");
            });
            kernels_agree::<DoubleLeaves<4>>(&soup, is_turned, |which, bvh, rays, wanted| {
                let mut any = vec![false; wanted.len()];
                run(which, Firsts { bvh, rays, answer: any.as_mut_slice() });
                assert!(any.iter().zip(wanted).all(|(&any, hit)| any == hit.is_hit()), "{which:?}");
            });
        }
    }
}
