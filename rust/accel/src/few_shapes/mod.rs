//! Brute-force intersection for scenes of few triangles and spheres, in SoA packets.
//!
//! For up to a few dozen shapes, testing sixteen rays against every one is faster than traversing a tree. Two triangles
//! that form a convex planar quadrilateral are tested as one. Each test is done in f32 with an error bound. Undecided
//! cases are decided in f64 ([`EdgeRay`], [`Sphere::meet`]), so that at most a hit within a rounding of f64 differs.

mod patch;
mod sphere;
#[cfg(test)]
mod tests;

use super::Primitives;
use patch::{EdgeLine, Half, Outline, Patch, UNIT, outline};
use raywright_base::math::single::{choose, greater, lesser, mask};
use raywright_base::math::{LANES, PathRays, Ray, Region};
use raywright_base::simd::{Dispatch, Kernel, Level, Simd, loops};
use raywright_shapes::triangle::EdgeRay;
use sphere::Sphere;

/// A few triangles and spheres, prepared for packets of rays.
#[derive(Clone, Debug)]
pub struct FewShapes {
    /// The shapes by number: first the triangles, then the spheres.
    patches: Vec<Patch>,
    spheres: Vec<Sphere>,
    /// The number of the shape of each primitive.
    shape_of: Vec<u32>,
    /// The primitives of each shape, and of none at the end.
    owners: Vec<Owners>,
    region: Region,
}

/// The primitives of a shape: where a quadrilateral is two, one on either side of its diagonal.
#[derive(Clone, Copy, Debug)]
struct Owners {
    /// The axes that the diagonal is given in.
    axes: [usize; 2],
    diagonal: EdgeLine,
    primitives: [u32; 2],
}

impl Owners {
    const fn one(primitive: u32) -> Self {
        Self { axes: [0, 1], diagonal: ([0.0; 2], 0.0), primitives: [primitive; 2] }
    }
}

/// Sixteen rays, and for each the shapes that it leaves and that it ends on.
struct Rays {
    origin: [[f32; LANES]; 3],
    direction: [[f32; LANES]; 3],
    /// Inverse directions, at most [`STEEPEST`].
    inverse: [[f32; LANES]; 3],
    /// By axis, 1 + 1/|n·d| of `FLAT` patches; and the rays' part of its factor in all error bounds ([`test`]).
    steeper: [[f32; LANES]; 3],
    unit: [f32; LANES],
    misses: [[u32; LANES]; 2],
}

/// The closest hits of sixteen rays.
struct Best {
    /// Between `near` and `far` lies `t`.
    near: [f32; LANES],
    far: [f32; LANES],
    shape: [u32; LANES],
    /// Bit masks of the shapes that were undecided.
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

/// The part of a shape's or a ray's largest coordinate in all error bounds ([`test`]).
#[inline(always)]
fn unit(size: f32) -> f32 {
    (64.0 * UNIT) * size
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
/// With ε = 2⁻²⁴, let S be the sum of the largest coordinates of patch and origin, and let t' be the exact distance of
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
    let [x, y, z] = patch.axes;
    let edges = &patch.edges;
    let [ox, oy, oz] = [&rays.origin[x], &rays.origin[y], &rays.origin[z]];
    let [dx, dy, dz] = [&rays.direction[x], &rays.direction[y], &rays.direction[z]];
    let (mut t, mut error) = ([0.0; LANES], [0.0; LANES]);
    if FLAT {
        for i in 0..LANES {
            t[i] = -(oz[i] - patch.height) * rays.inverse[z][i];
            error[i] = (patch.unit + rays.unit[i]) * rays.steeper[z][i];
        }
    } else {
        for i in 0..LANES {
            let above = fused::<FUSED>(patch.slopes[1], oy[i], oz[i] - patch.height);
            let above = fused::<FUSED>(patch.slopes[0], ox[i], above);
            let slope = fused::<FUSED>(patch.slopes[1], dy[i], dz[i]);
            let slope = fused::<FUSED>(patch.slopes[0], dx[i], slope);
            let steep = steepness(slope);
            t[i] = -above * steep.copysign(slope);
            let unit = patch.unit + rays.unit[i];
            error[i] = fused::<FUSED>(unit, steep, unit);
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
        let is_known = mask(index == rays.misses[0][i]) | mask(index == rays.misses[1][i]);
        accept::<ANY>(index, i, (t, error, off), is_known, best);
    }
}

/// Keeps a hit of a lane at `t`, which errs by at most `error`, if it is nearer than the one before. It is a hit for
/// certain if `off` is less than the error below zero, and none if it is more than the error above.
#[inline(always)]
fn accept<const ANY: bool>(index: u32, i: usize, (t, error, off): (f32, f32, f32), is_known: u32, best: &mut Best) {
    let (bit, word) = (1 << (index & 31), usize::from(index >= 32));
    let (near, far) = (t - error, t + error);
    let is_out = signs((error - off).to_bits() | (best.far[i] - near).to_bits()) | is_known;
    let is_certain = signs((off + error).to_bits() & (far - best.near[i]).to_bits());
    let is_hit = is_certain & !is_out;
    best.open[word][i] |= bit & !(is_out | is_certain);
    if ANY {
        // Behind all shapes from here on.
        best.far[i] = choose(is_hit, f32::MIN, best.far[i]);
        best.shape[i] &= !is_hit;
    } else {
        best.near[i] = choose(is_hit, near, best.near[i]);
        best.far[i] = choose(is_hit, far, best.far[i]);
        // Numbers of shapes increase, and NONE is less than all as a signed number. A selection would become a masked
        // store, which takes processors of AMD twelve cycles.
        let hit = (index | !is_hit).cast_signed();
        best.shape[i] = hit.max(best.shape[i].cast_signed()).cast_unsigned();
    }
}

/// Tests all shapes against sixteen rays.
struct TestAll<'a, const ANY: bool> {
    patches: &'a [Patch],
    spheres: &'a [Sphere],
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
        for (index, sphere) in (self.patches.len() as u32..).zip(self.spheres) {
            sphere.test::<ANY>(index, self.rays, self.best);
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

/// Sixteen entries of a column.
#[inline(always)]
fn sixteen<T>(column: &[T], start: usize) -> &[T; LANES] {
    column[start..].first_chunk().expect("room for sixteen")
}

loops! {
    /// Load sixteen rays.
    fn take(from: &PathRays, start: usize, extent: f32, shape_of: &[u32], rays: &mut Rays, best: &mut Best) {
        for axis in 0..3 {
            let (origin, direction) = (sixteen(&from.origin[axis], start), sixteen(&from.direction[axis], start));
            for i in 0..LANES {
                rays.origin[axis][i] = origin[i] as f32;
                rays.direction[axis][i] = direction[i];
                let steep = steepness(direction[i]);
                rays.steeper[axis][i] = 1.0 + steep;
                rays.inverse[axis][i] = steep.copysign(direction[i]);
            }
        }
        for i in 0..LANES {
            let (x, y, z) = (rays.origin[0][i].abs(), rays.origin[1][i].abs(), rays.origin[2][i].abs());
            let size = greater(greater(x, y), z);
            rays.unit[i] = unit(size);
            // No hit lies as far.
            best.far[i] = 2.0 * (extent + size);
        }
        let shape = |primitive: u32| shape_of.get(primitive as usize).copied().unwrap_or(NONE);
        let misses = sixteen(&from.misses, start);
        for i in 0..LANES {
            rays.misses[0][i] = shape(misses[i][0]);
        }
        // Only rays with a finite end have a target.
        if !from.t_max.is_empty() {
            let t_max = sixteen(&from.t_max, start);
            for i in 0..LANES {
                best.far[i] = lesser(t_max[i] as f32, best.far[i]);
            }
            for i in 0..LANES {
                rays.misses[1][i] = shape(misses[i][1]);
            }
        }
        for i in 0..LANES {
            // What ends within an error of the ray's end is open.
            let end = best.far[i];
            let room = (4.0 * UNIT) * end;
            best.near[i] = end - room;
            best.far[i] = end + room;
        }
        best.shape = [NONE; LANES];
        best.open = [[0; LANES]; 2];
    }
}

impl FewShapes {
    /// Maximum number of primitives. Trees are faster for more.
    pub const MOST: usize = 64;

    /// Prepare all primitives, if they are few triangles and spheres and their size suits f32.
    pub fn new(primitives: &dyn Primitives) -> Option<Self> {
        /// Minimum and maximum size of a scene, for which squares neither overflow nor underflow.
        const SIZES: [f64; 2] = [1e-12, 1e12];
        let (count, objects) = (primitives.count(), primitives.objects());
        if count > Self::MOST || objects.as_ref().is_some_and(|objects| objects.moves()) {
            return None;
        }
        let region = primitives.region();
        let (mut rest, mut round, mut shape_of) = (Vec::new(), Vec::new(), vec![NONE; count]);
        for primitive in 0..count as u32 {
            if objects.as_ref().is_some_and(|objects| objects.bounds(primitive).is_some()) {
                round.push((primitive, objects.as_ref()?.ball(primitive)?));
            } else if primitives.bounds(primitive).is_some() {
                rest.push(Half { primitive, corners: primitives.corners(primitive) });
            }
        }
        let mut patches = Vec::new();
        rest.reverse();
        while let Some(first) = rest.pop() {
            let quadrilateral = |second: &Half| outline(&[first, *second]).is_some();
            let partner = rest.iter().enumerate().rev().find(|(_, second)| quadrilateral(second));
            let halves = match partner.map(|(i, _)| i) {
                Some(i) => [Some(first), Some(rest.remove(i))],
                None => [Some(first), None],
            };
            for half in halves.iter().flatten() {
                shape_of[half.primitive as usize] = patches.len() as u32;
            }
            // Degenerate triangles cannot be hit.
            let Some(patch) = Patch::new(halves) else { continue };
            patches.push(patch);
        }
        let is_empty = patches.is_empty() && round.is_empty();
        if !is_empty && !(SIZES[0]..SIZES[1]).contains(&region.extent) {
            return None;
        }
        let mut spheres = Vec::new();
        for (primitive, (center, radius)) in round {
            shape_of[primitive as usize] = (patches.len() + spheres.len()) as u32;
            spheres.push(Sphere::new(primitive, center, radius));
        }
        let of_patch = |patch: &Patch| {
            let Patch { axes: [x, y, _], diagonal, primitives, .. } = *patch;
            Owners { axes: [x, y], diagonal, primitives }
        };
        let of_spheres = spheres.iter().map(|sphere| Owners::one(sphere.primitive));
        let owners = patches.iter().map(of_patch).chain(of_spheres).chain([Owners::one(NONE)]).collect();
        Some(Self { patches, spheres, shape_of, owners, region })
    }

    /// Find the first primitive that each ray hits, or [`Ray::NO_TRIANGLE`].
    pub fn closest(&self, level: Level, rays: &PathRays, primitives: &mut [u32]) {
        let none = self.owners.len() - 1;
        self.ask::<false>(level, rays, |start, rays, best| {
            for (i, to) in primitives[start..][..LANES].iter_mut().enumerate() {
                let Owners { axes: [x, y], diagonal, primitives } = &self.owners[none.min(best.shape[i] as usize)];
                // On the diagonal, one triangle is as good as the other.
                let t = 0.5 * (best.near[i] + best.far[i]);
                let p = |axis: usize| t * rays.direction[axis][i] + rays.origin[axis][i];
                *to = primitives[usize::from(beyond::<false>(*diagonal, [p(*x), p(*y)]) > 0.0)];
            }
        });
    }

    /// Test which rays hit anything.
    pub fn occluded(&self, level: Level, rays: &PathRays, occluded: &mut [bool]) {
        self.ask::<true>(level, rays, |start, _, best| {
            for (i, to) in occluded[start..][..LANES].iter_mut().enumerate() {
                *to = best.shape[i] != NONE;
            }
        });
    }

    /// Tests all shapes against all rays.
    fn ask<const ANY: bool>(&self, level: Level, from: &PathRays, mut answer: impl FnMut(usize, &Rays, &Best)) {
        let mut rays = Rays {
            origin: [[0.0; LANES]; 3],
            direction: [[0.0; LANES]; 3],
            inverse: [[0.0; LANES]; 3],
            steeper: [[0.0; LANES]; 3],
            unit: [0.0; LANES],
            misses: [[NONE; LANES]; 2],
        };
        let zero = [0.0; LANES];
        let mut best = Best { near: zero, far: zero, shape: [NONE; LANES], open: [[0; LANES]; 2] };
        for start in (0..from.len).step_by(LANES) {
            take(level, from, start, self.region.extent as f32, &self.shape_of, &mut rays, &mut best);
            let test = TestAll::<ANY> { patches: &self.patches, spheres: &self.spheres, rays: &rays, best: &mut best };
            if level.lanes() >= 8 {
                Dispatch::<8>::dispatch(level, test);
            } else {
                Dispatch::<4>::dispatch(level, test);
            }
            let some_open = best.open.iter().flatten().fold(0, |all, open| all | open);
            let end = if some_open == 0 { 0 } else { LANES.min(from.len - start) };
            for i in 0..end {
                let mut open = u64::from(best.open[1][i]) << 32 | u64::from(best.open[0][i]);
                while open != 0 && !(ANY && best.shape[i] != NONE) {
                    let shape = open.trailing_zeros();
                    open &= open - 1;
                    self.decide(shape, &from.get(start + i), i, &mut best);
                }
            }
            answer(start, &rays, &best);
        }
    }

    /// Decide in f64 whether a ray hits a shape before its closest hit so far.
    #[cold]
    #[inline(never)]
    fn decide(&self, shape: u32, ray: &Ray, lane: usize, best: &mut Best) {
        let Some((t, primitive)) = self.meet(shape, ray) else { return };
        if self.meet(best.shape[lane], ray).is_some_and(|before| before <= (t, primitive)) {
            return;
        }
        let t = t as f32;
        let room = 4.0 * UNIT * t;
        (best.near[lane], best.far[lane]) = (t - room, t + room);
        best.shape[lane] = shape;
    }

    /// Where a ray hits a shape first, and which primitive of it.
    fn meet(&self, shape: u32, ray: &Ray) -> Option<(f64, u32)> {
        if let Some(patch) = self.patches.get(shape as usize) {
            let edges = EdgeRay::new(ray, &self.region)?;
            let met = patch.halves.iter().flatten().filter_map(|half| Some((edges.meet(half.corners)?, *half)));
            let (met, half) = met.min_by(|a, b| a.0.t.total_cmp(&b.0.t).then(a.1.primitive.cmp(&b.1.primitive)))?;
            return Some((met.t * edges.scale, half.primitive));
        }
        let sphere = self.spheres.get((shape as usize).wrapping_sub(self.patches.len()))?;
        sphere.meet(ray).map(|t| (t, sphere.primitive))
    }
}
