//! The nearest point of any primitive: what a search for it knows, and when it may pass something by.
//!
//! Boxes are kept in f32, in box units ([`Region`]), rounded outwards; how far a point is from one is computed in f64.
//! With u = 2⁻⁵³ and P the point's largest coordinate in box units, the point errs by 2uP and a box by 2u for its
//! rounding to box units; a triangle's own distance errs by 2⁻⁴⁹ of the distance to its farthest corner, which is
//! 16u·√3·(P + 2) at most. The point is widened by 64u·(P + 2) along every axis, so that no box is thought farther than
//! the triangles in it are found to be.
//!
//! Along axes of a tree's own ([`Axes`]) all is half as long, and P the point's largest coordinate there, 2√3·P at most
//! in box units. So a triangle's distance errs by 8u·√3·(2√3·P + 2), the point by 5u·2√3·P, and a box by 10u; and
//! distances of up to √3·(P + √3) there are half of what they are to within 8u of themselves. In all that is less than
//! 80u·(P + 2), and the point is widened by 128u·(P + 2).

use raywright_base::math::robust::{greater, lesser, normalising_scale};
use raywright_base::math::{Axes, DVec3, Region};
use raywright_base::simd::Simd;
use raywright_shapes::triangle::{length, nearest_point, point_of};

/// Whether a primitive counts; all do without it.
pub type PrimitiveFilter<'a> = Option<&'a (dyn Fn(u32) -> bool + Sync)>;

/// The nearest point of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// How far it is; infinite if there is none.
    pub distance: f64,
    /// Where it is.
    pub position: DVec3,
    /// Weights of the second and the third corner.
    pub uv: [f64; 2],
    /// On which primitive; of several at the same distance, on the lowest.
    pub primitive: u32,
    /// Of an instance, on which primitive of the prototype, flattened.
    pub inner: u32,
}

impl Nearest {
    /// Nothing is near enough.
    pub const MISS: Self =
        Self { distance: f64::INFINITY, position: DVec3::NAN, uv: [0.0; 2], primitive: u32::MAX, inner: 0 };

    /// Whether there is such a point.
    pub fn is_hit(&self) -> bool {
        self.primitive != u32::MAX
    }
}

/// A point that looks for its nearest, and what it has found.
///
/// A point farther than 2²⁶ radii of the region is drawn closer, to between 2²⁶ and 2²⁷ of them: from there all
/// distances change alike, to within their rounding, but their differences keep more digits, so that boxes can still be
/// told apart.
#[derive(Clone, Copy, Debug)]
pub struct Search {
    /// As given.
    given: DVec3,
    /// As searched from.
    point: DVec3,
    /// In box units, rounded down and up.
    low: [f64; 3],
    high: [f64; 3],
    /// The greatest distance that counts.
    most: f64,
    /// Of the triangle that is nearest so far.
    distance: f64,
    primitive: u32,
    corners: [DVec3; 3],
    /// The square of a distance at which there is nothing as near.
    square: f64,
    /// How much the point is widened along every axis.
    pad: f64,
    /// From the scene's units to those of boxes.
    scale: f64,
}

impl Search {
    /// Begins; none if nothing can be found, since the point is NaN or infinite, the distance negative or NaN, or the
    /// region empty.
    #[inline(always)]
    pub fn new(point: DVec3, max_distance: f64, region: &Region) -> Option<Self> {
        Self::along(None, point, max_distance, region)
    }

    /// Begins where boxes lie along axes of a tree's own, if there are any.
    #[inline(always)]
    pub fn along(axes: Option<&Axes>, point: DVec3, max_distance: f64, region: &Region) -> Option<Self> {
        const FAR: f64 = (1u64 << 26) as f64;
        const PAD: f64 = 1.0 / (1u64 << 47) as f64;
        if !(point.is_finite() && max_distance >= 0.0) || region.is_empty() {
            return None;
        }
        // Half of it, lest it overflow.
        let away = point / 2.0 - region.centre / 2.0;
        let size = away.abs().max_element();
        let is_far = size * region.scale > FAR && region.radius > 0.0;
        let searched = if is_far {
            let (inverse, _) = normalising_scale(greater(size, f64::MIN_POSITIVE));
            region.centre + away * inverse * (FAR / region.scale)
        } else {
            point
        };
        // No coordinate of a region of one point is scaled, and a box there is farther than this if at all.
        let [x, y, z] = region.to_box_along(axes, searched).to_array().map(|x| greater(lesser(x, 1e300), -1e300));
        let (widths, scale) = if axes.is_some() { (2.0, Axes::SCALE * region.scale) } else { (1.0, region.scale) };
        let pad = widths * PAD * (greater(greater(x.abs(), y.abs()), z.abs()) + 2.0);
        let distance = if is_far { f64::INFINITY } else { max_distance };
        Some(Self {
            given: point,
            point: searched,
            low: [x - pad, y - pad, z - pad],
            high: [x + pad, y + pad, z + pad],
            most: max_distance,
            distance,
            primitive: u32::MAX,
            corners: [DVec3::ZERO; 3],
            square: limit(distance),
            pad: pad / scale,
            scale,
        })
    }

    /// Looks at a triangle; true if it is the nearest so far.
    #[inline(always)]
    pub fn offer(&mut self, primitive: u32, corners: [DVec3; 3]) -> bool {
        // Most triangles of a leaf are too far, which their boxes tell for a quarter of the work.
        let [a, b, c] = corners;
        let mut square = 0.0;
        for axis in 0..3 {
            let least = lesser(lesser(a[axis], b[axis]), c[axis]);
            let greatest = greater(greater(a[axis], b[axis]), c[axis]);
            square += gap(least, greatest, self.point[axis] - self.pad, self.point[axis] + self.pad);
        }
        if square > self.square {
            return false;
        }
        let distance = nearest_point(corners, self.point).distance;
        let is_nearer = distance < self.distance || (distance == self.distance && primitive < self.primitive);
        if is_nearer {
            (self.distance, self.primitive, self.corners) = (distance, primitive, corners);
            self.square = limit(distance);
        }
        is_nearer
    }

    /// The squares of the distances to some boxes by axis and side, in their units: never more than those to any
    /// triangle in them, as [`Search::offer`] has it. Infinite for an empty box.
    #[inline(always)]
    pub fn squares<const N: usize>(&self, planes: &[[[f32; N]; 2]; 3]) -> [f64; N] {
        let mut squares = [0.0; N];
        for axis in 0..3 {
            let (low, high) = (self.low[axis], self.high[axis]);
            for lane in 0..N {
                let (lower, upper) = (f64::from(planes[axis][0][lane]), f64::from(planes[axis][1][lane]));
                squares[lane] += gap(lower, upper, low, high);
            }
        }
        squares
    }

    /// What starts at a greater square than this has nothing as near as what is found.
    #[inline(always)]
    pub fn limit(&self) -> f64 {
        limit(self.distance * self.scale)
    }

    /// What was found.
    #[inline(always)]
    pub fn finish(&self) -> Nearest {
        if self.primitive == u32::MAX {
            return Nearest::MISS;
        }
        let uv = nearest_point(self.corners, self.point).uv;
        let position = point_of(self.corners, uv);
        let distance = if self.point == self.given { self.distance } else { length(self.given - position) };
        // What is farther than an f64 can say is not found either.
        if distance <= self.most && distance.is_finite() {
            Nearest { distance, position, uv, primitive: self.primitive, inner: 0 }
        } else {
            Nearest::MISS
        }
    }
}

/// Tells which triangles of a leaf are too far, side by side and in f32.
///
/// Whatever the vector w, all of a triangle is at least as far as the least w · (corner − point) / |w|. With w towards
/// the triangle's middle that misses little where the triangle is small next to its distance.
///
/// The bound. Let ε = 2⁻²⁴ and L bound |point| + |corner| in every coordinate. The point errs by εL, a corner by up to
/// 4εL if it is kept as an edge in box units, and their difference by εL; so the product of w and that, of three terms
/// that are each rounded three times at most, errs by 9εL·(|w₁| + |w₂| + |w₃|) and the distance by 9√3·εL < 15.6εL.
/// 16εL is allowed, and in box units 32εL. The vector is what it is and does not err; squares err by 8ε of themselves,
/// for which 16ε are.
#[derive(Clone, Copy, Debug)]
pub struct LeafTest {
    /// In the units that leaves are kept in.
    point: [f32; 3],
    /// What is allowed.
    slack: f64,
    /// From the scene's units to those of leaves.
    scale: f64,
}

impl LeafTest {
    const STEP: f64 = 1.0 / (1u32 << 20) as f64;

    /// Readies a search for leaves that hold corners as they are, or in box units.
    #[inline(always)]
    pub fn new(search: &Search, region: &Region, as_they_are: bool) -> Self {
        let (point, extent, scale, step) = if as_they_are {
            (search.point, region.extent, 1.0, Self::STEP)
        } else {
            (region.to_box(search.point), 2.0, region.scale, 2.0 * Self::STEP)
        };
        let slack = step * (point.abs().max_element() + extent);
        Self { point: point.as_vec3().to_array(), slack, scale }
    }

    /// The square of the distance at which triangles are too far.
    #[inline(always)]
    pub fn limit(&self, search: &Search) -> f32 {
        let distance = search.distance * self.scale + self.slack;
        (distance * distance * (1.0 + Self::STEP)) as f32
    }

    /// Of triangles whose corners stand in lanes, those that may be near enough.
    // Written out, axis by axis: closures between here and the kernel's entry are not always compiled for its level.
    #[inline(always)]
    pub fn not_rejected<const N: usize, S: Simd<N>>(&self, simd: S, corners: [[S::F32; 3]; 3], limit: f32) -> u32 {
        let point = [simd.splat(self.point[0]), simd.splat(self.point[1]), simd.splat(self.point[2])];
        let a = difference(simd, corners[0], point);
        let b = difference(simd, corners[1], point);
        let c = difference(simd, corners[2], point);
        let way = [
            simd.add(simd.add(a[0], b[0]), c[0]),
            simd.add(simd.add(a[1], b[1]), c[1]),
            simd.add(simd.add(a[2], b[2]), c[2]),
        ];
        let least = simd.min(simd.min(dot(simd, way, a), dot(simd, way, b)), dot(simd, way, c));
        let least = simd.max(least, simd.splat(0.0));
        // What underflows is not rejected.
        let most = simd.mul_add(dot(simd, way, way), simd.splat(limit), simd.splat(f32::MIN_POSITIVE));
        !simd.gt(simd.mul(least, least), most)
    }
}

#[inline(always)]
fn difference<const N: usize, S: Simd<N>>(simd: S, a: [S::F32; 3], b: [S::F32; 3]) -> [S::F32; 3] {
    [simd.sub(a[0], b[0]), simd.sub(a[1], b[1]), simd.sub(a[2], b[2])]
}

#[inline(always)]
fn dot<const N: usize, S: Simd<N>>(simd: S, a: [S::F32; 3], b: [S::F32; 3]) -> S::F32 {
    simd.mul_add(a[2], b[2], simd.mul_add(a[1], b[1], simd.mul(a[0], b[0])))
}

/// The square of how far apart two intervals are.
#[inline(always)]
fn gap(lower: f64, upper: f64, low: f64, high: f64) -> f64 {
    let gap = greater(greater(lower - high, low - upper), 0.0);
    gap * gap
}

/// The square beyond which nothing is as near as a distance: a little more, lest rounding matter, and where squares
/// underflow, where all are as near.
#[inline(always)]
fn limit(distance: f64) -> f64 {
    const ROOM: f64 = 1.0 + 1.0 / (1u64 << 48) as f64;
    greater(distance * distance * ROOM, f64::MIN_POSITIVE)
}

/// The greatest distance of point `i`: of one for all, or one a point.
#[inline(always)]
pub fn of(max_distances: &[f64], i: usize) -> f64 {
    if max_distances.len() == 1 { max_distances[0] } else { max_distances[i] }
}
