//! Sixteen rays in SoA layout, prepared and tested against a triangle together.
//!
//! Every loop runs over all columns without branches and treats each ray as [`EdgeRay`] does, in the same order and
//! with the same roundings. So the compiler vectorizes it, and the bits are the same.

use super::EdgeRay;
use super::depth::Depth;
use super::edge::LEAST;
use raywright_base::math::robust::{greater, lesser};
use raywright_base::math::{DVec3, Ray, RayBatch, Region};

/// Rays per packet.
pub const RAYS: usize = 16;

/// One number per ray.
pub type Column<T> = [T; RAYS];

/// Sixteen rays prepared for triangles; [`EdgeRay`] explains the fields.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct EdgeRays {
    /// Origins as given, by axis.
    pub origin: [Column<f64>; 3],
    /// Origins relative to the region's center.
    pub local: [Column<f64>; 3],
    /// Directions as given.
    unscaled: [Column<f64>; 3],
    /// Scaled directions, after `prepare`.
    pub direction: [Column<f64>; 3],
    /// Along the scaled directions, after `prepare`.
    pub t_min: Column<f64>,
    /// Along the scaled directions, after `prepare`.
    pub t_max: Column<f64>,
    /// `t` along the given direction over `t` along the scaled one.
    pub scale: Column<f64>,
    /// Bound on every coordinate of a corner relative to the origin.
    pub largest: Column<f64>,
}

/// Intersections of sixteen rays with a triangle.
pub struct Met {
    /// Rays that certainly hit it.
    pub met: u32,
    /// Rays that f64 cannot decide.
    pub open: u32,
    /// `t` along the scaled directions, or along the given ones.
    pub t: Column<f64>,
    /// Barycentric weights of the second and the third corner.
    pub uv: [Column<f64>; 2],
}

impl Met {
    /// No intersections.
    pub const NONE: Self = Self { met: 0, open: 0, t: [0.0; RAYS], uv: [[0.0; RAYS]; 2] };
}

impl Default for EdgeRays {
    fn default() -> Self {
        let zero = [0.0; RAYS];
        Self {
            origin: [zero; 3],
            local: [zero; 3],
            unscaled: [zero; 3],
            direction: [zero; 3],
            t_min: zero,
            t_max: zero,
            scale: zero,
            largest: zero,
        }
    }
}

/// One bit for each ray.
#[inline(always)]
pub fn bits(flags: &Column<u32>) -> u32 {
    let mut all = 0;
    for i in 0..RAYS {
        all |= flags[i] << i;
    }
    all
}

/// All rays.
pub const ALL: u32 = u32::MAX >> (32 - RAYS);

impl EdgeRays {
    /// Take up to sixteen rays of a batch, at least one. The last one fills missing places.
    #[inline(always)]
    pub fn take(&mut self, rays: &RayBatch<'_>, from: usize) {
        match rays {
            RayBatch::Rows(rays) => {
                let rays = &rays[from..];
                for i in 0..RAYS {
                    self.put(i, &rays[if i < rays.len() { i } else { rays.len() - 1 }]);
                }
            }
            RayBatch::Columns(columns) => {
                let (origin, direction, t_min, t_max) = columns.parts();
                origin.read(from, &mut self.origin);
                direction.read(from, &mut self.unscaled);
                t_min.read(from, &mut self.t_min);
                t_max.read(from, &mut self.t_max);
            }
        }
    }

    /// Replace the `i`-th ray.
    #[inline(always)]
    pub fn put(&mut self, i: usize, ray: &Ray) {
        let i = i & (RAYS - 1);
        (self.origin[0][i], self.origin[1][i], self.origin[2][i]) = (ray.origin.x, ray.origin.y, ray.origin.z);
        let d = ray.direction;
        (self.unscaled[0][i], self.unscaled[1][i], self.unscaled[2][i]) = (d.x, d.y, d.z);
        (self.t_min[i], self.t_max[i]) = (ray.t_min, ray.t_max);
    }

    /// Prepare the rays that were taken, and return which are plain. Excluded are rays that cannot hit anything, are
    /// far from the scene, or whose direction is near the ends of the exponent range. Those are better traced one by
    /// one.
    #[inline(always)]
    pub fn prepare(&mut self, region: &Region) -> u32 {
        let mut plain = [0u32; RAYS];
        for i in 0..RAYS {
            let (ox, oy, oz) = (self.origin[0][i], self.origin[1][i], self.origin[2][i]);
            let (dx, dy, dz) = (self.unscaled[0][i], self.unscaled[1][i], self.unscaled[2][i]);
            let longest = greater(greater(dx.abs(), dy.abs()), dz.abs());
            let finite = ox * 0.0 + dx * 0.0 + (oy * 0.0 + dy * 0.0) + (oz * 0.0 + dz * 0.0) == 0.0;
            let biased = longest.to_bits() >> 52;
            let (scale, inverse) = (f64::from_bits(2046u64.wrapping_sub(biased) << 52), f64::from_bits(biased << 52));
            self.direction[0][i] = dx * scale;
            self.direction[1][i] = dy * scale;
            self.direction[2][i] = dz * scale;
            self.scale[i] = scale;
            let ordered = self.t_min[i] <= self.t_max[i];
            self.t_min[i] = EdgeRay::scaled_end(self.t_min[i], inverse, scale, LEAST);
            self.t_max[i] = EdgeRay::scaled_end(self.t_max[i], inverse, scale, -LEAST);
            let (lx, ly, lz) = (ox - region.centre.x, oy - region.centre.y, oz - region.centre.z);
            self.local[0][i] = lx;
            self.local[1][i] = ly;
            self.local[2][i] = lz;
            let far = greater(greater(lx.abs(), ly.abs()), lz.abs());
            self.largest[i] = far + region.radius;
            let near = far <= EdgeRay::FAR * region.radius;
            // The largest numbers have a subnormal inverse.
            let normal = (biased > 0) & (biased < 2046);
            plain[i] = u32::from(finite & ordered & near & normal);
        }
        bits(&plain)
    }

    /// Test all rays against a triangle; only the results of those in `asked` are used. Multiplication may be `fused`.
    #[inline(always)]
    pub fn meet(&self, fused: bool, [a, b, c]: [DVec3; 3], asked: u32) -> Met {
        let mut met = Met::NONE;
        let (mut certain, mut open) = ([0u32; RAYS], [0u32; RAYS]);
        for i in 0..RAYS {
            let corners = [[a.x, a.y, a.z], [b.x, b.y, b.z], [c.x, c.y, c.z]];
            let o = self.origin(i);
            (certain[i], open[i], met.t[i], met.uv[0][i], met.uv[1][i]) = self.meet_one::<false>(fused, i, o, corners);
        }
        met.met = bits(&certain) & asked;
        met.open = bits(&open) & asked;
        met
    }

    /// Compute the intersection of each ray with a triangle of its own, given by corner and axis, that it is known to
    /// hit between `t_min` and `t_max`. Rays for which f64 is not certain of `t` are open. Only those in `asked` count.
    /// Multiplication may be `fused`.
    #[inline(always)]
    pub fn won<T: Copy + Into<f64>>(&self, fused: bool, [a, b, c]: &[[Column<T>; 3]; 3], asked: u32) -> Met {
        /// Not a closure: those are not always inlined.
        #[inline(always)]
        fn of<T: Copy + Into<f64>>(corner: &[Column<T>; 3], i: usize) -> [f64; 3] {
            [corner[0][i].into(), corner[1][i].into(), corner[2][i].into()]
        }
        let mut met = Met::NONE;
        let mut certain = [0u32; RAYS];
        for i in 0..RAYS {
            let corners = [of(a, i), of(b, i), of(c, i)];
            certain[i] = self.won_one(fused, i, self.origin(i), corners, &mut met);
        }
        met.met = bits(&certain) & asked;
        met.open = asked & !met.met;
        met
    }

    /// The same for a triangle that all rays in `asked` hit from one origin ([`EdgeRays::share_origin`]). Two thirds of
    /// the work depend on these alone and are done once.
    #[inline(always)]
    pub fn won_together(&self, fused: bool, corners: [DVec3; 3], asked: u32) -> Met {
        let [a, b, c] = corners;
        let (o, corners) = (self.origin(0), [[a.x, a.y, a.z], [b.x, b.y, b.z], [c.x, c.y, c.z]]);
        let mut met = Met::NONE;
        let mut certain = [0u32; RAYS];
        for i in 0..RAYS {
            certain[i] = self.won_one(fused, i, o, corners, &mut met);
        }
        met.met = bits(&certain) & asked;
        met.open = asked & !met.met;
        met
    }

    /// Return whether all rays that were taken have the same origin, bit for bit.
    #[inline(always)]
    pub fn share_origin(&self) -> bool {
        let mut differ = 0;
        for axis in 0..3 {
            for i in 0..RAYS {
                differ |= self.origin[axis][i].to_bits() ^ self.origin[axis][0].to_bits();
            }
        }
        differ == 0
    }

    #[inline(always)]
    fn origin(&self, i: usize) -> [f64; 3] {
        [self.origin[0][i], self.origin[1][i], self.origin[2][i]]
    }

    /// Store the hit of a ray; return whether it is certain.
    #[inline(always)]
    fn won_one(&self, fused: bool, i: usize, o: [f64; 3], corners: [[f64; 3]; 3], to: &mut Met) -> u32 {
        let (_, is_open, t, v, w) = self.meet_one::<true>(fused, i, o, corners);
        let t = t * self.scale[i];
        (to.t[i], to.uv[0][i], to.uv[1][i]) = (t, v, w);
        u32::from((is_open == 0) & (t.abs() <= f64::MAX))
    }

    /// Return whether a ray certainly hits a triangle, whether that is open, `t`, and the weights of the second and the
    /// third corner. With `WON` the first is known to be true and is not used.
    #[inline(always)]
    fn meet_one<const WON: bool>(
        &self,
        fused: bool,
        i: usize,
        [ox, oy, oz]: [f64; 3],
        corners: [[f64; 3]; 3],
    ) -> (u32, u32, f64, f64, f64) {
        let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = corners;
        let (dx, dy, dz) = (self.direction[0][i], self.direction[1][i], self.direction[2][i]);
        let (ax, ay, az) = (ax - ox, ay - oy, az - oz);
        let (bx, by, bz) = (bx - ox, by - oy, bz - oz);
        let (cx, cy, cz) = (cx - ox, cy - oy, cz - oz);
        let u = volume(dx, dy, dz, bx, by, bz, cx, cy, cz);
        let v = volume(dx, dy, dz, cx, cy, cz, ax, ay, az);
        let w = volume(dx, dy, dz, ax, ay, az, bx, by, bz);
        let largest = self.largest[i];
        let above = EdgeRay::sign_error(largest);
        let passed = !WON & ((u > above) | (v > above) | (w > above)) & ((u < -above) | (v < -above) | (w < -above));
        let (sx, sy, sz) = (dx.abs(), dy.abs(), dz.abs());
        let longest = greater(greater(sx, sy), sz);
        let (is_x, is_y) = (sx == longest, sy == longest);
        let za = if is_x {
            ax
        } else if is_y {
            ay
        } else {
            az
        };
        let zb = if is_x {
            bx
        } else if is_y {
            by
        } else {
            bz
        };
        let zc = if is_x {
            cx
        } else if is_y {
            cy
        } else {
            cz
        };
        let least = lesser(lesser(u.abs(), v.abs()), w.abs());
        let sum = u + v + w;
        let range = greater(greater(za, zb), zc) - lesser(lesser(za, zb), zc);
        let depth = Depth::new(fused, [ox, oy, oz], [dx, dy, dz], corners);
        let t = depth.t;
        let is_beyond = !WON & depth.is_beyond(self.t_min[i], self.t_max[i]);
        let is_certain = (least > above)
            & (6.0 * above * range <= EdgeRay::T_ERROR * largest * sum.abs())
            & if WON { depth.is_surely_known() } else { depth.is_known() | is_beyond };
        let counts = (t >= self.t_min[i]) & (t <= self.t_max[i]) & ((t * self.scale[i]).abs() <= f64::MAX) & !is_beyond;
        (u32::from(!passed & is_certain & counts), u32::from(!passed & !is_certain), t, v / sum, w / sum)
    }
}

/// `d · ((v − w) × (v + w))`.
#[inline(always)]
#[allow(clippy::too_many_arguments)]
fn volume(dx: f64, dy: f64, dz: f64, vx: f64, vy: f64, vz: f64, wx: f64, wy: f64, wz: f64) -> f64 {
    let (px, py, pz) = (vx - wx, vy - wy, vz - wz);
    let (qx, qy, qz) = (vx + wx, vy + wy, vz + wz);
    dx * (py * qz - qy * pz) + dy * (pz * qx - qz * px) + dz * (px * qy - qx * py)
}
