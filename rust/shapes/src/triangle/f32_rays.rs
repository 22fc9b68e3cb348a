//! Sixteen rays in SoA layout, rounded to f32 for boxes and for the triangle pretest.
//!
//! Rays given in f32 are scaled in f32, exactly, which takes half the registers. Every loop runs over all columns
//! without branches, so the compiler vectorizes it.

use super::EdgeRay;
use super::sixteen_rays::{Column, RAYS, bits};
use raywright_base::math::robust::greater;
use raywright_base::math::{RayBatch, Region, Vectors, read_column};
use raywright_base::simd::Lanes;
use std::ops::{Add, Mul};

/// Sixteen rays in f32.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct PlainRays {
    /// Origins as given, rounded.
    pub origin: [Column<f32>; 3],
    /// Origins relative to the region's center, in box units.
    pub local: [Column<f32>; 3],
    /// Directions, scaled by a power of two so that the largest coordinate lies in [1, 2).
    pub direction: [Column<f32>; 3],
    /// Along the scaled direction, rounded.
    pub t_min: Column<f32>,
    /// Along the scaled direction, rounded.
    pub t_max: Column<f32>,
    /// Bound on every coordinate of a corner relative to the origin, in box units, slightly padded.
    pub largest: Column<f32>,
    /// Upper bound on `t` along the given direction over `t` along the scaled one.
    pub scale: f64,
    /// The plain rays. Excluded are rays that cannot hit anything, are far from the scene, or whose direction is near
    /// the ends of the exponent range. The fields of excluded rays are undefined.
    pub plain: u32,
}

/// The float type of the given rays.
trait Real: Copy + PartialOrd + Add<Output = Self> + Mul<Output = Self> {
    const ZERO: Self;
    /// The sum of the biased exponents of a power of two and its inverse.
    const BOTH: u32;
    /// The biased exponent.
    fn exponent(self) -> u32;
    /// The power of two with a biased exponent.
    fn power(exponent: u32) -> Self;
    fn size(self) -> Self;
    fn single(self) -> f32;
    fn double(self) -> f64;
    /// An upper bound on sixteen numbers; NaN is ignored.
    fn greatest(column: &Column<Self>) -> f64;
}

impl Real for f32 {
    const ZERO: Self = 0.0;
    const BOTH: u32 = 254;
    #[inline(always)]
    fn exponent(self) -> u32 {
        self.to_bits() >> 23
    }
    #[inline(always)]
    fn power(exponent: u32) -> Self {
        Self::from_bits(exponent << 23)
    }
    #[inline(always)]
    fn size(self) -> Self {
        self.abs()
    }
    #[inline(always)]
    fn single(self) -> f32 {
        self
    }
    #[inline(always)]
    fn double(self) -> f64 {
        self.into()
    }
    #[inline(always)]
    fn greatest(_: &Column<Self>) -> f64 {
        f32::MAX.into()
    }
}

impl Real for f64 {
    const ZERO: Self = 0.0;
    const BOTH: u32 = 2046;
    #[inline(always)]
    fn exponent(self) -> u32 {
        (self.to_bits() >> 52) as u32
    }
    #[inline(always)]
    fn power(exponent: u32) -> Self {
        Self::from_bits(u64::from(exponent) << 52)
    }
    #[inline(always)]
    fn size(self) -> Self {
        self.abs()
    }
    #[inline(always)]
    fn single(self) -> f32 {
        self as f32
    }
    #[inline(always)]
    fn double(self) -> f64 {
        self
    }
    #[inline(always)]
    fn greatest(column: &Column<Self>) -> f64 {
        let mut most = 0.0;
        for x in column {
            most = greater(*x, most);
        }
        most
    }
}

/// Sixteen vectors in place, if there are as many.
#[inline(always)]
fn whole<'a>(columns: &[&'a [f32]; 3], from: usize) -> Option<[&'a Column<f32>; 3]> {
    let [x, y, z] = columns;
    Some([x[from..].first_chunk()?, y[from..].first_chunk()?, z[from..].first_chunk()?])
}

/// Up to sixteen vectors. The last one fills missing places.
#[inline(always)]
fn some(columns: &[&[f32]; 3], from: usize) -> [Column<f32>; 3] {
    let mut some = [[0.0; RAYS]; 3];
    for axis in 0..3 {
        read_column(columns[axis], from, &mut some[axis]);
    }
    some
}

impl PlainRays {
    /// No rays.
    pub const NONE: Self = Self {
        origin: [[0.0; RAYS]; 3],
        local: [[0.0; RAYS]; 3],
        direction: [[0.0; RAYS]; 3],
        t_min: [0.0; RAYS],
        t_max: [0.0; RAYS],
        largest: [0.0; RAYS],
        scale: 1.0,
        plain: 0,
    };

    /// Take up to sixteen rays of a batch, at least one. The last one fills missing places.
    #[inline(always)]
    pub fn take<S: Lanes<RAYS>>(&mut self, simd: S, rays: &RayBatch<'_>, from: usize, region: &Region) {
        let mut t = [[0.0; RAYS]; 2];
        match rays {
            RayBatch::Rows(rays) => {
                let rays = &rays[from..];
                let (mut o, mut d) = ([[0.0; RAYS]; 3], [[0.0; RAYS]; 3]);
                for i in 0..RAYS {
                    let ray = &rays[if i < rays.len() { i } else { rays.len() - 1 }];
                    (o[0][i], o[1][i], o[2][i]) = (ray.origin.x, ray.origin.y, ray.origin.z);
                    (d[0][i], d[1][i], d[2][i]) = (ray.direction.x, ray.direction.y, ray.direction.z);
                    (t[0][i], t[1][i]) = (ray.t_min, ray.t_max);
                }
                self.make(simd, o.each_ref(), d.each_ref(), &t, region);
            }
            RayBatch::Columns(columns) => {
                let (origin, direction, t_min, t_max) = columns.parts();
                t_min.read(from, &mut t[0]);
                t_max.read(from, &mut t[1]);
                if let (Vectors::Single(origin), Vectors::Single(direction)) = (origin, direction) {
                    let (some_o, some_d);
                    let o = match whole(origin, from) {
                        Some(o) => o,
                        None => {
                            some_o = some(origin, from);
                            some_o.each_ref()
                        }
                    };
                    let d = match whole(direction, from) {
                        Some(d) => d,
                        None => {
                            some_d = some(direction, from);
                            some_d.each_ref()
                        }
                    };
                    self.make(simd, o, d, &t, region);
                } else {
                    let (mut o, mut d) = ([[0f64; RAYS]; 3], [[0f64; RAYS]; 3]);
                    origin.read(from, &mut o);
                    direction.read(from, &mut d);
                    self.make(simd, o.each_ref(), d.each_ref(), &t, region);
                }
            }
        }
    }

    #[inline(always)]
    fn make<T: Real, S: Lanes<RAYS>>(
        &mut self,
        simd: S,
        o: [&Column<T>; 3],
        d: [&Column<T>; 3],
        [t_min, t_max]: &[Column<f64>; 2],
        region: &Region,
    ) {
        let mut plain = [0u32; RAYS];
        let mut scales = [T::ZERO; RAYS];
        for i in 0..RAYS {
            let (ox, oy, oz) = (o[0][i], o[1][i], o[2][i]);
            let (dx, dy, dz) = (d[0][i], d[1][i], d[2][i]);
            let longest = greater(greater(dx.size(), dy.size()), dz.size());
            // Zero times infinity or NaN is NaN: one comparison tests six numbers.
            let (x, y, z) = (ox * T::ZERO + dx * T::ZERO, oy * T::ZERO + dy * T::ZERO, oz * T::ZERO + dz * T::ZERO);
            let finite = x + y + z == T::ZERO;
            let exponent = longest.exponent();
            let scale = T::power(T::BOTH.wrapping_sub(exponent));
            self.direction[0][i] = (dx * scale).single();
            self.direction[1][i] = (dy * scale).single();
            self.direction[2][i] = (dz * scale).single();
            scales[i] = scale;
            let inverse = T::power(exponent).double();
            self.t_min[i] = (t_min[i] * inverse) as f32;
            self.t_max[i] = (t_max[i] * inverse) as f32;
            // The largest numbers have a subnormal inverse.
            let normal = (exponent > 0) & (exponent < T::BOTH);
            plain[i] = u32::from(finite & normal & (t_min[i] <= t_max[i]));
        }
        for axis in 0..3 {
            for i in 0..RAYS {
                self.origin[axis][i] = o[axis][i].single();
                self.local[axis][i] = ((o[axis][i].double() - region.centre[axis]) * region.scale) as f32;
            }
        }
        /// Allowance for rounding.
        const ROOM: f32 = 1.0 + 1.0 / (1u32 << 21) as f32;
        // If the scale is no normal f32, `t` in box units is unknown.
        let radius = if (region.scale as f32).is_normal() { (region.radius * region.scale) as f32 } else { f32::NAN };
        let [x, y, z] = [simd.load(&self.local[0]), simd.load(&self.local[1]), simd.load(&self.local[2])];
        let away = simd.max(simd.max(simd.abs(x), simd.abs(y)), simd.abs(z));
        let largest = simd.mul(simd.add(away, simd.splat(radius)), simd.splat(ROOM));
        simd.store(largest, &mut self.largest);
        let near = simd.le(away, simd.splat(radius * EdgeRay::FAR as f32));
        self.plain = bits(&plain) & near;
        self.scale = T::greatest(&scales);
    }

    /// Bound on every coordinate of a corner relative to the origin of a plain ray, in box units.
    #[inline(always)]
    pub fn most<S: Lanes<RAYS>>(&self, simd: S) -> f64 {
        // NaN in other lanes must not hide the maximum.
        simd.greatest(simd.select(self.plain, simd.load(&self.largest), simd.splat(0.0))).into()
    }

    /// Bound on |origin| + |corner| of the plain rays, in the scene's units.
    #[inline(always)]
    pub fn absolute<S: Lanes<RAYS>>(&self, simd: S, region: &Region) -> f64 {
        let [x, y, z] = [simd.load(&self.origin[0]), simd.load(&self.origin[1]), simd.load(&self.origin[2])];
        let away = simd.max(simd.max(simd.abs(x), simd.abs(y)), simd.abs(z));
        // An allowance for the rounding of the origins.
        let away = simd.select(self.plain, away, simd.splat(0.0));
        (f64::from(simd.greatest(away)) + region.extent) * (1.0 + 1.0 / (1u32 << 22) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::super::ALL;
    use super::*;
    use raywright_base::math::{DVec3, Numbers, Ray, RayColumns};
    use raywright_base::simd::Scalar;

    fn region() -> Region {
        Region::around([DVec3::new(-3.0, 2.0, 5.0), DVec3::new(4.0, 9.0, 7.0)])
    }

    fn rays() -> Vec<Ray> {
        let number = |i: usize| (i as f64 * 0.618_034).fract() - 0.5;
        let vector =
            |i: usize| DVec3::new(number(3 * i + 1), number(3 * i + 2), number(3 * i + 3)).as_vec3().as_dvec3();
        (0..RAYS).map(|i| Ray::new(8.0 * vector(i), vector(i + RAYS) * 2f64.powi(i as i32 * 4 - 30))).collect()
    }

    #[test]
    fn f32_and_f64_are_made_ready_alike() {
        let (rays, region) = (rays(), region());
        let column = |of: fn(&Ray) -> f64| rays.iter().map(|r| of(r) as f32).collect::<Vec<_>>();
        let o = [column(|r| r.origin.x), column(|r| r.origin.y), column(|r| r.origin.z)];
        let d = [column(|r| r.direction.x), column(|r| r.direction.y), column(|r| r.direction.z)];
        let (o, d) = (o.each_ref().map(Vec::as_slice), d.each_ref().map(Vec::as_slice));
        let columns =
            RayColumns::new(Vectors::Single(o), Vectors::Single(d), Numbers::One(0.0), Numbers::One(f64::INFINITY));
        let (mut rows, mut single) = (PlainRays::NONE, PlainRays::NONE);
        rows.take(Scalar, &RayBatch::Rows(&rays), 0, &region);
        single.take(Scalar, &RayBatch::Columns(columns), 0, &region);
        assert_eq!((rows.plain, single.plain), (ALL, ALL));
        assert_eq!((rows.direction, rows.local, rows.largest), (single.direction, single.local, single.largest));
        assert_eq!((rows.t_min, rows.t_max), (single.t_min, single.t_max));
        for i in 0..RAYS {
            let edges = EdgeRay::new(&rays[i], &region).expect("a ray");
            let of = |columns: &[Column<f32>; 3]| {
                DVec3::new(columns[0][i].into(), columns[1][i].into(), columns[2][i].into())
            };
            assert_eq!(of(&rows.direction), edges.direction.as_vec3().as_dvec3());
            assert_eq!(of(&rows.local), (edges.local * region.scale).as_vec3().as_dvec3());
            assert!(f64::from(rows.largest[i]) >= edges.largest * region.scale);
        }
    }

    #[test]
    fn rays_that_are_none_do_not_change_what_is_said_of_others() {
        let (rays, region) = (rays(), region());
        let mut all = PlainRays::NONE;
        all.take(Scalar, &RayBatch::Rows(&rays), 0, &region);
        let bounds = |plain: &PlainRays| (plain.most(Scalar), plain.absolute(Scalar, &region));
        for spoilt in [
            Ray::new(DVec3::NAN, DVec3::X),
            Ray::new(DVec3::splat(f64::INFINITY), DVec3::X),
            Ray::new(DVec3::ZERO, DVec3::NAN),
            Ray::new(DVec3::ZERO, DVec3::ZERO),
            Ray::new(DVec3::splat(1e9), DVec3::X),
            Ray { t_min: 1.0, t_max: 0.0, ..rays[0] },
            Ray { t_min: f64::NAN, ..rays[0] },
        ] {
            for at in 0..RAYS {
                let mut some = rays.clone();
                some[at] = spoilt;
                let mut plain = PlainRays::NONE;
                plain.take(Scalar, &RayBatch::Rows(&some), 0, &region);
                assert_eq!(plain.plain, ALL & !(1 << at), "{spoilt:?}");
                // The bound of the other rays, and no more.
                let others: Vec<_> = (0..RAYS).filter(|&i| i != at).map(|i| rays[i]).collect();
                let mut wanted = PlainRays::NONE;
                wanted.take(Scalar, &RayBatch::Rows(&others), 0, &region);
                assert_eq!(bounds(&plain), bounds(&wanted));
            }
        }
    }
}
