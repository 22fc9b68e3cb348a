//! Brute-force intersection for scenes of few triangles, in SoA packets.
//!
//! For up to a few dozen triangles, testing sixteen rays against every triangle is faster than traversing a tree. Two
//! triangles that form a convex planar quadrilateral are tested as one. Each test is done in f32 with an error bound.
//! Undecided cases are decided in f64 by the triangles themselves ([`EdgeRay`]), so hits are as exact as everywhere
//! else.

mod patch;

use super::Primitives;
use patch::{EdgeLine, Half, Outline, Patch, UNIT, outline};
use raywright_base::math::single::{choose, greater, lesser, mask};
use raywright_base::math::{LANES, PathRays, Ray, Region};
use raywright_base::simd::{Dispatch, Kernel, Level, Simd, loops};
use raywright_shapes::triangle::EdgeRay;

/// A few triangles, prepared for packets of rays.
#[derive(Clone, Debug)]
pub struct FewTriangles {
    patches: Vec<Patch>,
    /// The patch of each primitive.
    patch_of: Vec<u32>,
    region: Region,
}

/// Sixteen rays, and for each the patches to ignore: that of its origin and that of its end.
struct Rays {
    origin: [[f32; LANES]; 3],
    direction: [[f32; LANES]; 3],
    /// Inverse directions, at most [`STEEPEST`].
    inverse: [[f32; LANES]; 3],
    /// The error bound of `FLAT` patches by axis, and the factor of 1 + 1/|n·d| in all bounds ([`test`]).
    error: [[f32; LANES]; 3],
    unit: [f32; LANES],
    misses: [[u32; LANES]; 2],
}

/// The closest hits of sixteen rays.
struct Best {
    /// Between `near` and `far` lies `t`.
    near: [f32; LANES],
    far: [f32; LANES],
    patch: [u32; LANES],
    /// Bit masks of the patches that were undecided.
    open: [[u32; LANES]; 2],
}

/// The greatest inverse of a slope. Its products with sizes of scenes, up to 4e12, stay finite.
const STEEPEST: f32 = 1e24;

/// Marks a lane without a hit.
const NONE: u32 = u32::MAX;

/// `a · b + c`, fused where the processor supports it. The error bounds cover both.
#[inline(always)]
fn fused<const FUSED: bool>(a: f32, b: f32, c: f32) -> f32 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// One over the size of a slope.
#[inline(always)]
fn steepness(slope: f32) -> f32 {
    lesser(1.0 / slope.abs(), STEEPEST)
}

/// Return all bits if the sign bit is set. Signs combine in whole registers; masks of comparisons are narrowed first.
#[inline(always)]
fn signs(bits: u32) -> u32 {
    (bits.cast_signed() >> 31).cast_unsigned()
}

/// The signed distance of a point from a line.
#[inline(always)]
fn beyond<const FUSED: bool>(([x, y], offset): EdgeLine, p: [f32; 2]) -> f32 {
    fused::<FUSED>(x, p[0], fused::<FUSED>(y, p[1], -offset))
}

/// Tests the patch of number `index`. With `ANY`, every hit is noted as patch 0. A `FLAT` patch is normal to an axis.
///
/// With ε = 2⁻²⁴, let S be the sum of the largest coordinates of scene and origin, and let t' be the exact distance of
/// a hit: t' ≤ √3·S, as directions have length 1. The numerator of `t` errs by at most 15εS: sums of numbers up to S,
/// and the roundings of the plane and the origin. The denominator errs by at most 7ε, for a normal whose largest
/// coordinate is 1. So |t − t'| ≤ (15 + 7√3)εS/|n·d| + εt', with the computed n·d. The position errs by that and
/// 2ε(S + t'), and its distances across edges by 6ε(S + t') more. The far corner of a quadrilateral may lie off its
/// plane by 2εS ([`outline`]), which moves it and its edges by no more than twice that. 64εS(1 + 1/|n·d|) is more than
/// the sum.
#[inline(always)]
fn test<const FUSED: bool, const OUTLINE: usize, const FLAT: bool, const ANY: bool>(
    patch: &Patch,
    index: u32,
    rays: &Rays,
    best: &mut Best,
) {
    let bit = 1 << (index & 31);
    let word = usize::from(index >= 32);
    let [x, y, z] = patch.axes;
    let edges = &patch.edges;
    let [ox, oy, oz] = [&rays.origin[x], &rays.origin[y], &rays.origin[z]];
    let [dx, dy, dz] = [&rays.direction[x], &rays.direction[y], &rays.direction[z]];
    let (mut t, mut error) = ([0.0; LANES], [0.0; LANES]);
    if FLAT {
        for i in 0..LANES {
            t[i] = -(oz[i] - patch.height) * rays.inverse[z][i];
            error[i] = rays.error[z][i];
        }
    } else {
        for i in 0..LANES {
            let above = fused::<FUSED>(patch.slopes[1], oy[i], oz[i] - patch.height);
            let above = fused::<FUSED>(patch.slopes[0], ox[i], above);
            let slope = fused::<FUSED>(patch.slopes[1], dy[i], dz[i]);
            let slope = fused::<FUSED>(patch.slopes[0], dx[i], slope);
            let steep = steepness(slope);
            t[i] = -above * steep.copysign(slope);
            error[i] = fused::<FUSED>(rays.unit[i], steep, rays.unit[i]);
        }
    }
    if ANY {
        // The walls of a room separate none of its points: most planes lie beyond all sixteen rays.
        let mut is_near = [0; LANES];
        for i in 0..LANES {
            is_near[i] = !signs((t[i] + error[i]).to_bits() | (best.far[i] - (t[i] - error[i])).to_bits());
        }
        if is_near.iter().fold(0, |all, lane| all | lane) == 0 {
            return;
        }
    }
    for i in 0..LANES {
        let (t, error) = (t[i], error[i]);
        let p = [fused::<FUSED>(t, dx[i], ox[i]), fused::<FUSED>(t, dy[i], oy[i])];
        let across = |edge: usize| beyond::<FUSED>(edges[edge], p);
        let outside = if OUTLINE == Outline::Parallelogram as usize {
            greater(across(0).abs() - patch.reach[0], across(1).abs() - patch.reach[1])
        } else if OUTLINE == Outline::Triangle as usize {
            greater(greater(across(0), across(1)), across(2))
        } else {
            greater(greater(across(0), across(1)), greater(across(2), across(3)))
        };
        // How far the point lies off the patch, or the patch behind the ray.
        let off = greater(outside, -t);
        let (near, far) = (t - error, t + error);
        // Only shadow rays end on a triangle.
        let is_known = mask(index == rays.misses[0][i]) | if ANY { mask(index == rays.misses[1][i]) } else { 0 };
        let is_out = signs((error - off).to_bits() | (best.far[i] - near).to_bits()) | is_known;
        let is_certain = signs((off + error).to_bits() & (far - best.near[i]).to_bits());
        let is_hit = is_certain & !is_out;
        best.open[word][i] |= bit & !(is_out | is_certain);
        if ANY {
            // Behind all patches from here on.
            best.far[i] = choose(is_hit, f32::MIN, best.far[i]);
            best.patch[i] &= !is_hit;
        } else {
            best.near[i] = choose(is_hit, near, best.near[i]);
            best.far[i] = choose(is_hit, far, best.far[i]);
            best.patch[i] = index & is_hit | best.patch[i] & !is_hit;
        }
    }
}

/// Tests all patches against sixteen rays.
struct TestAll<'a, const ANY: bool> {
    patches: &'a [Patch],
    rays: &'a Rays,
    best: &'a mut Best,
}

impl<const N: usize, const ANY: bool> Kernel<N> for TestAll<'_, ANY> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd<N>>(self, _: S) {
        for (index, patch) in (0u32..).zip(self.patches) {
            const TRIANGLE: usize = Outline::Triangle as usize;
            const PARALLELOGRAM: usize = Outline::Parallelogram as usize;
            const QUADRILATERAL: usize = Outline::Quadrilateral as usize;
            let (rays, best) = (self.rays, &mut *self.best);
            match patch.outline {
                Outline::Triangle => either::<S, N, TRIANGLE, ANY>(patch, index, rays, best),
                Outline::Parallelogram => either::<S, N, PARALLELOGRAM, ANY>(patch, index, rays, best),
                Outline::Quadrilateral => either::<S, N, QUADRILATERAL, ANY>(patch, index, rays, best),
            }
        }
    }
}

/// Tests one patch, across an axis or not, with products that are fused where the processor can.
#[inline(always)]
fn either<S: Simd<N>, const N: usize, const OUTLINE: usize, const ANY: bool>(
    patch: &Patch,
    index: u32,
    rays: &Rays,
    best: &mut Best,
) {
    match (S::FUSED, patch.slopes == [0.0; 2]) {
        (true, true) => test::<true, OUTLINE, true, ANY>(patch, index, rays, best),
        (true, false) => test::<true, OUTLINE, false, ANY>(patch, index, rays, best),
        (false, true) => test::<false, OUTLINE, true, ANY>(patch, index, rays, best),
        (false, false) => test::<false, OUTLINE, false, ANY>(patch, index, rays, best),
    }
}

loops! {
    /// Load sixteen rays.
    fn take(from: &PathRays, start: usize, extent: f32, patch_of: &[u32], rays: &mut Rays, best: &mut Best) {
        let end = start + LANES;
        for axis in 0..3 {
            for (to, &from) in rays.origin[axis].iter_mut().zip(&from.origin[axis][start..end]) {
                *to = from as f32;
            }
            rays.direction[axis].copy_from_slice(&from.direction[axis][start..end]);
        }
        for i in 0..LANES {
            let (x, y, z) = (rays.origin[0][i].abs(), rays.origin[1][i].abs(), rays.origin[2][i].abs());
            let size = extent + greater(greater(x, y), z);
            rays.unit[i] = (64.0 * UNIT) * size;
            // No hit lies as far.
            best.far[i] = 2.0 * size;
        }
        for (inverse, (error, direction)) in rays.inverse.iter_mut().zip(rays.error.iter_mut().zip(&rays.direction)) {
            for i in 0..LANES {
                let steep = steepness(direction[i]);
                error[i] = rays.unit[i] + rays.unit[i] * steep;
                inverse[i] = steep.copysign(direction[i]);
            }
        }
        if let Some(from) = from.t_max.get(start..end) {
            for (to, &from) in best.far.iter_mut().zip(from) {
                *to = lesser(from as f32, *to);
            }
        }
        let patch = |primitive: u32| patch_of.get(primitive as usize).copied().unwrap_or(NONE);
        for (to, &[left, _]) in rays.misses[0].iter_mut().zip(&from.misses[start..end]) {
            *to = patch(left);
        }
        // Only rays with a finite end have a target triangle.
        if !from.t_max.is_empty() {
            for (to, &[_, reached]) in rays.misses[1].iter_mut().zip(&from.misses[start..end]) {
                *to = patch(reached);
            }
        }
        for i in 0..LANES {
            // What ends within an error of the ray's end is open.
            let end = best.far[i];
            let room = (4.0 * UNIT) * end;
            best.near[i] = end - room;
            best.far[i] = end + room;
        }
        best.patch = [NONE; LANES];
        best.open = [[0; LANES]; 2];
    }
}

impl FewTriangles {
    /// Maximum number of triangles. Trees are faster for more.
    pub const MOST: usize = 64;

    /// Prepare all primitives, if they are few triangles and their size suits f32.
    pub fn new(primitives: &dyn Primitives) -> Option<Self> {
        /// Minimum and maximum size of a scene, for which squares neither overflow nor underflow.
        const SIZES: [f64; 2] = [1e-12, 1e12];
        let count = primitives.count();
        if count > Self::MOST || primitives.objects().is_some() {
            return None;
        }
        let region = primitives.region();
        let halves = (0..count as u32).filter(|&p| primitives.bounds(p).is_some());
        let mut rest: Vec<_> = halves.map(|p| Half { primitive: p, corners: primitives.corners(p) }).collect();
        let (mut patches, mut patch_of) = (Vec::new(), vec![NONE; count]);
        rest.reverse();
        while let Some(first) = rest.pop() {
            let quadrilateral = |second: &Half| outline(&[first, *second], region.extent).is_some();
            let partner = rest.iter().enumerate().rev().find(|(_, second)| quadrilateral(second));
            let halves = match partner.map(|(i, _)| i) {
                Some(i) => [Some(first), Some(rest.remove(i))],
                None => [Some(first), None],
            };
            for half in halves.iter().flatten() {
                patch_of[half.primitive as usize] = patches.len() as u32;
            }
            // Degenerate triangles cannot be hit.
            let Some(patch) = Patch::new(halves, region.extent) else { continue };
            if !(SIZES[0]..SIZES[1]).contains(&region.extent) {
                return None;
            }
            patches.push(patch);
        }
        Some(Self { patches, patch_of, region })
    }

    /// Find the first triangle that each ray hits, or [`Ray::NO_TRIANGLE`].
    pub fn closest(&self, level: Level, rays: &PathRays, primitives: &mut [u32]) {
        self.ask::<false>(level, rays, |start, rays, best| {
            for (i, to) in primitives[start..][..LANES].iter_mut().enumerate() {
                *to = self.patches.get(best.patch[i] as usize).map_or(NONE, |patch| {
                    // On the diagonal, one triangle is as good as the other.
                    let t = 0.5 * (best.near[i] + best.far[i]);
                    let p = |axis: usize| t * rays.direction[axis][i] + rays.origin[axis][i];
                    let is_second = beyond::<false>(patch.diagonal, [p(patch.axes[0]), p(patch.axes[1])]) > 0.0;
                    patch.primitives[usize::from(is_second)]
                });
            }
        });
    }

    /// Test which rays hit anything.
    pub fn occluded(&self, level: Level, rays: &PathRays, occluded: &mut [bool]) {
        self.ask::<true>(level, rays, |start, _, best| {
            for (i, to) in occluded[start..][..LANES].iter_mut().enumerate() {
                *to = best.patch[i] != NONE;
            }
        });
    }

    /// Tests all patches against all rays.
    fn ask<const ANY: bool>(&self, level: Level, from: &PathRays, mut answer: impl FnMut(usize, &Rays, &Best)) {
        let mut rays = Rays {
            origin: [[0.0; LANES]; 3],
            direction: [[0.0; LANES]; 3],
            inverse: [[0.0; LANES]; 3],
            error: [[0.0; LANES]; 3],
            unit: [0.0; LANES],
            misses: [[NONE; LANES]; 2],
        };
        let zero = [0.0; LANES];
        let mut best = Best { near: zero, far: zero, patch: [NONE; LANES], open: [[0; LANES]; 2] };
        for start in (0..from.len).step_by(LANES) {
            take(level, from, start, self.region.extent as f32, &self.patch_of, &mut rays, &mut best);
            let test = TestAll::<ANY> { patches: &self.patches, rays: &rays, best: &mut best };
            if level.lanes() >= 8 {
                Dispatch::<8>::dispatch(level, test);
            } else {
                Dispatch::<4>::dispatch(level, test);
            }
            let some_open = best.open.iter().flatten().fold(0, |all, open| all | open);
            let end = if some_open == 0 { 0 } else { LANES.min(from.len - start) };
            for i in 0..end {
                let mut open = u64::from(best.open[1][i]) << 32 | u64::from(best.open[0][i]);
                while open != 0 && !(ANY && best.patch[i] != NONE) {
                    let patch = open.trailing_zeros() as usize;
                    open &= open - 1;
                    self.decide(&self.patches[patch], &from.get(start + i), i, &mut best);
                }
            }
            answer(start, &rays, &best);
        }
    }

    /// Decide in f64 whether a ray hits a patch before its closest hit so far.
    #[cold]
    #[inline(never)]
    fn decide(&self, patch: &Patch, ray: &Ray, lane: usize, best: &mut Best) {
        let Some(edges) = EdgeRay::new(ray, &self.region) else { return };
        let meet = |patch: &Patch| {
            let met = patch.halves.iter().flatten().filter_map(|half| Some((edges.meet(half.corners)?, *half)));
            met.min_by(|a, b| a.0.t.total_cmp(&b.0.t).then(a.1.primitive.cmp(&b.1.primitive)))
        };
        let Some((new, half)) = meet(patch) else { return };
        if let Some((old, other)) = self.patches.get(best.patch[lane] as usize).and_then(meet)
            && (old.t, other.primitive) <= (new.t, half.primitive)
        {
            return;
        }
        let t = (new.t * edges.scale) as f32;
        let room = 4.0 * UNIT * t;
        (best.near[lane], best.far[lane]) = (t - room, t + room);
        best.patch[lane] = self.patch_of[half.primitive as usize];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BruteForce;
    use crate::fans::{Soup, fans};
    use raywright_base::math::{Hit, Vec3};
    use raywright_base::sampling::philox4x32;

    fn number(i: u32) -> f32 {
        philox4x32([i, 0, 0, 0], [3, 9])[0] as f32 / (1u32 << 31) as f32 - 1.0
    }

    /// A room with a box in it, of parallelograms, and some triangles, on a grid so that rays hit corners and edges.
    fn room(scale: f32) -> Vec<[Vec3; 3]> {
        let mut all = Vec::new();
        for (low, high) in [([-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]), ([-0.5, -1.0, -0.5], [0.25, 0.0, 0.25])] {
            for axis in 0..3 {
                for side in [low, high] {
                    let corner = |u: bool, v: bool| {
                        let mut p = low;
                        p[axis] = side[axis];
                        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
                        (p[a], p[b]) = (if u { high[a] } else { low[a] }, if v { high[b] } else { low[b] });
                        Vec3::from_array(p) * scale
                    };
                    let [a, b, c, d] =
                        [(false, false), (true, false), (true, true), (false, true)].map(|(u, v)| corner(u, v));
                    all.extend([[a, b, c], [c, d, a]]);
                }
            }
        }
        for i in 0..20 {
            all.push([0, 1, 2].map(|k| Vec3::from_array([0, 1, 2].map(|x| scale * number(9 * i + 3 * k + x)))));
        }
        all
    }

    fn rays(scale: f32) -> PathRays {
        let of_fans = fans().into_iter().flatten().map(|ray| (ray.origin.as_vec3(), ray.direction.as_vec3()));
        // From grid points to grid points.
        let grid = |i: u32| Vec3::from_array([0, 1, 2].map(|x| (4.0 * number(3 * i + x)).round() / 4.0));
        let of_grid = (0..4000).map(|i| (grid(i), grid(i + 5000) - grid(i)));
        let all: Vec<_> = of_fans.chain(of_grid).filter(|(_, d)| d.length() > 0.0).collect();
        let mut rays = PathRays::with_room(all.len(), false);
        rays.len = all.len();
        for (i, (origin, direction)) in all.into_iter().enumerate() {
            let (origin, direction) = (origin * scale, direction.normalize());
            for axis in 0..3 {
                rays.origin[axis][i] = origin[axis].into();
                rays.direction[axis][i] = direction[axis];
            }
            rays.t_max[i] = if i % 3 == 0 { scale.into() } else { f64::INFINITY };
        }
        rays
    }

    #[test]
    fn hits_are_those_of_brute_force() {
        for (scale, is_single) in [(1.0, true), (1e-6, false), (3.7e5, true)] {
            let soup = Soup { triangles: room(scale), is_single };
            let rays = rays(scale);
            let few = FewTriangles::new(&soup).expect("few triangles");
            assert_eq!(few.patches.len(), 32, "parallelograms and triangles");
            let exact: Vec<_> = (0..rays.len).map(|i| rays.get(i)).collect();
            let mut wanted = vec![Hit::MISS; rays.len];
            BruteForce::over(&soup, Level::current().unwrap()).intersect(&exact, &mut wanted);
            let mut first = None;
            for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
                let mut hits = vec![0; rays.len + LANES];
                few.closest(level, &rays, &mut hits);
                let mut occluded = vec![false; rays.len + LANES];
                few.occluded(level, &rays, &mut occluded);
                for (i, wanted) in wanted.iter().enumerate() {
                    assert_eq!(occluded[i], wanted.is_hit(), "{i} at {scale}: {:?} {wanted:?}", exact[i]);
                    assert_eq!(hits[i] != NONE, wanted.is_hit(), "{i} at {scale}");
                    if wanted.is_hit() {
                        // On the diagonal of a quadrilateral either triangle is correct.
                        let patch = |primitive: u32| few.patch_of[primitive as usize];
                        assert_eq!(patch(hits[i]), patch(wanted.primitive), "{i} at {scale}: {:?}", exact[i]);
                    }
                }
                let bits = hits[..rays.len].to_vec();
                assert!(*first.get_or_insert(bits.clone()) == bits, "{level:?} at {scale}");
            }
        }
    }

    #[test]
    fn a_ray_misses_what_it_leaves_and_what_it_goes_to() {
        let soup = Soup { triangles: room(1.0), is_single: true };
        let few = FewTriangles::new(&soup).unwrap();
        let (mut rays, mut hits) = (PathRays::with_room(1, false), [0; 1 + LANES]);
        rays.len = 1;
        // From the floor of the room straight up, past the box.
        for (axis, (origin, direction)) in [(0.8, 0.0), (-1.0, 1.0), (0.8, 0.0)].into_iter().enumerate() {
            (rays.origin[axis][0], rays.direction[axis][0]) = (origin, direction);
        }
        let level = Level::current().unwrap();
        few.closest(level, &rays, &mut hits);
        let floor = hits[0];
        rays.misses[0][0] = floor;
        few.closest(level, &rays, &mut hits);
        let ceiling = hits[0];
        assert_eq!(soup.corners(floor).map(|corner| corner.y), [-1.0; 3]);
        assert_eq!(soup.corners(ceiling).map(|corner| corner.y), [1.0; 3]);
        let mut occluded = [false; 1 + LANES];
        few.occluded(level, &rays, &mut occluded);
        assert!(occluded[0]);
        rays.misses[0][1] = ceiling;
        few.occluded(level, &rays, &mut occluded);
        assert!(!occluded[0]);
    }
}
