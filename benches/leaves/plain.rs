//! Leaves as most ray tracers have them: the test of Möller and Trumbore (1997) in f32, whose answer is believed.

use raywright::math::{DVec3, Region};
use raywright::shapes::triangle::{
    BlockRay, BlockRays, Column, EdgeRay, EdgeRays, Leaves, RAYS, Rows, SingleLeaves, Sixteen,
};
use raywright::shapes::{Candidate, Contact};
use raywright::simd::Simd;

/// Triangles kept as [`SingleLeaves`] keeps them, in the same order.
pub struct PlainLeaves<const N: usize>(SingleLeaves<N>);

impl<const N: usize> Leaves<N> for PlainLeaves<N> {
    const PRECISION: &'static str = "plain";
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
    fn ray(ray: &EdgeRay, region: &Region) -> BlockRay {
        <SingleLeaves<N> as Leaves<N>>::ray(ray, region)
    }

    #[inline(always)]
    fn rays(rays: &EdgeRays, region: &Region) -> BlockRays {
        <SingleLeaves<N> as Leaves<N>>::rays(rays, region)
    }

    fn bytes(&self) -> usize {
        self.0.bytes()
    }

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
        let (mut hit, numbers) = self.lanes(simd, first, count, lanes, [ray.t_min as f32, ray.t_max as f32]);
        if hit == 0 {
            return false;
        }
        let numbers = numbers.stored(simd);
        while hit != 0 {
            let lane = hit.trailing_zeros() as usize & (N - 1);
            hit &= hit - 1;
            if met(self.primitive(first, count, lane), candidate(&numbers, lane)) {
                return true;
            }
        }
        false
    }

    #[inline(always)]
    fn meet_sixteen<S: Simd<N>>(
        &self,
        simd: S,
        first: usize,
        count: u32,
        rays: &Sixteen,
        active: u32,
        mut met: impl FnMut(usize, u32, Candidate),
    ) {
        if active.count_ones() <= 2 * count {
            let mut rest = active;
            while rest != 0 {
                let i = rest.trailing_zeros() as usize & (RAYS - 1);
                rest &= rest - 1;
                let interval = [rays.edges.t_min[i] as f32, rays.edges.t_max[i] as f32];
                let (mut hit, numbers) = self.lanes(simd, first, count, &rays.blocks.of(i), interval);
                if hit == 0 {
                    continue;
                }
                let numbers = numbers.stored(simd);
                while hit != 0 {
                    let lane = hit.trailing_zeros() as usize & (N - 1);
                    hit &= hit - 1;
                    met(i, self.primitive(first, count, lane), candidate(&numbers, lane));
                }
            }
            return;
        }
        let (mut t_min, mut t_max) = ([0f32; RAYS], [0f32; RAYS]);
        for i in 0..RAYS {
            t_min[i] = rays.edges.t_min[i] as f32;
            t_max[i] = rays.edges.t_max[i] as f32;
        }
        for lane in 0..count as usize {
            let corners = self.corners(first, count, lane);
            let primitive = self.primitive(first, count, lane);
            let [a, b, c] = [splat(simd, corners[0]), splat(simd, corners[1]), splat(simd, corners[2])];
            for part in 0..RAYS / N {
                let (o, d) = (&rays.blocks.origin, &rays.blocks.direction);
                let o = [part_of(simd, &o[0], part), part_of(simd, &o[1], part), part_of(simd, &o[2], part)];
                let d = [part_of(simd, &d[0], part), part_of(simd, &d[1], part), part_of(simd, &d[2], part)];
                let interval = [part_of(simd, &t_min, part), part_of(simd, &t_max, part)];
                let (hit, numbers) = moller_trumbore(simd, [a, b, c], o, d, interval);
                let mut hit = hit & (active >> (part * N)) & (u32::MAX >> (32 - N));
                if hit == 0 {
                    continue;
                }
                let numbers = numbers.stored(simd);
                while hit != 0 {
                    let i = hit.trailing_zeros() as usize & (N - 1);
                    hit &= hit - 1;
                    met(part * N + i, primitive, candidate(&numbers, i));
                }
            }
        }
    }
}

impl<const N: usize> PlainLeaves<N> {
    /// The lanes of a leaf that a ray meets, and the numbers of each meeting.
    #[inline(always)]
    fn lanes<S: Simd<N>>(
        &self,
        simd: S,
        first: usize,
        count: u32,
        ray: &BlockRay,
        interval: [f32; 2],
    ) -> (u32, Numbers<S::F32>) {
        let o = [simd.splat(ray.origin[0]), simd.splat(ray.origin[1]), simd.splat(ray.origin[2])];
        let d = [simd.splat(ray.direction[0]), simd.splat(ray.direction[1]), simd.splat(ray.direction[2])];
        let a = self.rows().numbers(simd, first, count, 0);
        let b = self.rows().numbers(simd, first, count, 1);
        let c = self.rows().numbers(simd, first, count, 2);
        let interval = [simd.splat(interval[0]), simd.splat(interval[1])];
        let (hit, numbers) = moller_trumbore(simd, [a, b, c], o, d, interval);
        (hit & ((1 << count) - 1), numbers)
    }
}

/// The numbers whose quotients make `t` and `uv`.
struct Numbers<F> {
    denominator: F,
    t: F,
    u: F,
    v: F,
}

impl<F: Copy> Numbers<F> {
    #[inline(always)]
    fn stored<const N: usize, S: Simd<N, F32 = F>>(&self, simd: S) -> Numbers<[f32; N]> {
        let mut to = Numbers { denominator: [0.0; N], t: [0.0; N], u: [0.0; N], v: [0.0; N] };
        simd.store(self.denominator, &mut to.denominator);
        simd.store(self.t, &mut to.t);
        simd.store(self.u, &mut to.u);
        simd.store(self.v, &mut to.v);
        to
    }
}

/// What is met in a lane. One division, as the few that are met do not fill a vector.
#[inline(always)]
fn candidate<const N: usize>(numbers: &Numbers<[f32; N]>, lane: usize) -> Candidate {
    let inverse = 1.0 / numbers.denominator[lane];
    let [t, u, v] = [numbers.t[lane], numbers.u[lane], numbers.v[lane]].map(|x| f64::from(x * inverse));
    Candidate { t, uv: [u, v], contact: Contact::Inside, inner: 0 }
}

/// Lanes that are met within an interval; bits above the lanes mean nothing. Nothing is divided: where the denominator
/// is negative all signs are turned.
#[inline(always)]
fn moller_trumbore<const N: usize, S: Simd<N>>(
    simd: S,
    [a, b, c]: [[S::F32; 3]; 3],
    o: [S::F32; 3],
    d: [S::F32; 3],
    interval: [S::F32; 2],
) -> (u32, Numbers<S::F32>) {
    let (e, f, s) = (difference(simd, b, a), difference(simd, c, a), difference(simd, o, a));
    let p = cross(simd, d, f);
    let q = cross(simd, s, e);
    let (u, v) = (dot(simd, s, p), dot(simd, d, q));
    let (t, denominator) = (dot(simd, f, q), dot(simd, e, p));
    let w = simd.sub(simd.sub(denominator, u), v);
    let zero = simd.splat(0.0);
    let positive = simd.gt(u, zero) | simd.gt(v, zero) | simd.gt(w, zero);
    let negative = simd.gt(zero, u) | simd.gt(zero, v) | simd.gt(zero, w);
    let (from, until) = (simd.mul(interval[0], denominator), simd.mul(interval[1], denominator));
    let ahead = simd.gt(denominator, zero) & simd.le(from, t) & simd.le(t, until)
        | simd.gt(zero, denominator) & simd.le(t, from) & simd.le(until, t);
    (ahead & !(positive & negative), Numbers { denominator, t, u, v })
}

/// A point in every lane.
#[inline(always)]
fn splat<const N: usize, S: Simd<N>>(simd: S, p: DVec3) -> [S::F32; 3] {
    [simd.splat(p.x as f32), simd.splat(p.y as f32), simd.splat(p.z as f32)]
}

/// One vector of a column.
#[inline(always)]
fn part_of<const N: usize, S: Simd<N>>(simd: S, column: &Column<f32>, part: usize) -> S::F32 {
    simd.load(&column.as_chunks::<N>().0[part])
}

#[inline(always)]
fn difference<const N: usize, S: Simd<N>>(simd: S, a: [S::F32; 3], b: [S::F32; 3]) -> [S::F32; 3] {
    [simd.sub(a[0], b[0]), simd.sub(a[1], b[1]), simd.sub(a[2], b[2])]
}

#[inline(always)]
fn cross<const N: usize, S: Simd<N>>(simd: S, a: [S::F32; 3], b: [S::F32; 3]) -> [S::F32; 3] {
    [
        simd.mul_sub(a[1], b[2], simd.mul(a[2], b[1])),
        simd.mul_sub(a[2], b[0], simd.mul(a[0], b[2])),
        simd.mul_sub(a[0], b[1], simd.mul(a[1], b[0])),
    ]
}

#[inline(always)]
fn dot<const N: usize, S: Simd<N>>(simd: S, a: [S::F32; 3], b: [S::F32; 3]) -> S::F32 {
    simd.mul_add(a[0], b[0], simd.mul_add(a[1], b[1], simd.mul(a[2], b[2])))
}
