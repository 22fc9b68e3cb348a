//! The state of a nearest-point query, and conservative distance tests.
//!
//! Boxes are stored in f32, in box units ([`Region`]), rounded outward; distances to them are computed in f64. With u =
//! 2⁻⁵³ and P the point's largest coordinate in box units, the point errs by 2uP, and a box by 2u for its rounding to
//! box units. A triangle's own distance errs by 2⁻⁴⁹ of the distance to its farthest corner, which is at most
//! 16u·√3·(P + 2). The point is widened by 64u·(P + 2) along every axis, so that the distance to a box never exceeds
//! the computed distances to its triangles.
//!
//! Along a tree's own axes ([`Axes`]) all lengths are halved, and P is the point's largest coordinate there, at most
//! 2√3·P in box units. So a triangle's distance errs by 8u·√3·(2√3·P + 2), the point by 5u·2√3·P, and a box by 10u.
//! Distances of up to √3·(P + √3) there are half the true ones to within 8u of themselves. In all that is less than
//! 80u·(P + 2), and the point is widened by 128u·(P + 2).

use raywright_base::math::robust::{greater, lesser, normalising_scale};
use raywright_base::math::{Axes, DVec3, Region};
use raywright_base::simd::Simd;
use raywright_shapes::triangle::{length, nearest_point, point_of};

/// A filter that accepts or rejects primitives; without it all count.
pub type PrimitiveFilter<'a> = Option<&'a (dyn Fn(u32) -> bool + Sync)>;

/// The nearest point of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// The distance; infinite if there is none.
    pub distance: f64,
    /// The position.
    pub position: DVec3,
    /// Barycentric weights of the second and the third corner.
    pub uv: [f64; 2],
    /// The primitive; of several at the same distance, the lowest.
    pub primitive: u32,
    /// Of an instance, the flattened primitive of the prototype.
    pub inner: u32,
}

impl Nearest {
    /// No point is near enough.
    pub const MISS: Self =
        Self { distance: f64::INFINITY, position: DVec3::NAN, uv: [0.0; 2], primitive: u32::MAX, inner: 0 };

    /// Return whether there is such a point.
    pub fn is_hit(&self) -> bool {
        self.primitive != u32::MAX
    }
}

/// A query point and its nearest point so far.
///
/// A point farther than 2²⁶ radii of the region is moved closer, to between 2²⁶ and 2²⁷ radii. From there all distances
/// change equally, to within rounding. Their differences keep more digits, which distinguishes boxes.
#[derive(Clone, Copy, Debug)]
pub struct Search {
    /// The point as given.
    given: DVec3,
    /// The point after moving.
    point: DVec3,
    /// In box units, rounded down and up.
    low: [f64; 3],
    high: [f64; 3],
    /// Maximum distance.
    most: f64,
    /// The nearest triangle so far.
    distance: f64,
    primitive: u32,
    corners: [DVec3; 3],
    /// A squared distance beyond which nothing can be as near.
    square: f64,
    /// The widening of the point along every axis.
    pad: f64,
    /// The factor from the scene's units to those of boxes.
    scale: f64,
}

impl Search {
    /// Begin a search. None if nothing can be found: the point is not finite, the distance negative or NaN, or the
    /// region empty.
    #[inline(always)]
    pub fn new(point: DVec3, max_distance: f64, region: &Region) -> Option<Self> {
        Self::along(None, point, max_distance, region)
    }

    /// Begin a search in a tree with its own axes, if given.
    #[inline(always)]
    pub fn along(axes: Option<&Axes>, point: DVec3, max_distance: f64, region: &Region) -> Option<Self> {
        const FAR: f64 = (1u64 << 26) as f64;
        const PAD: f64 = 1.0 / (1u64 << 47) as f64;
        if !(point.is_finite() && max_distance >= 0.0) || region.is_empty() {
            return None;
        }
        // Halved to avoid overflow.
        let away = point / 2.0 - region.centre / 2.0;
        let size = away.abs().max_element();
        let is_far = size * region.scale > FAR && region.radius > 0.0;
        let searched = if is_far {
            let (inverse, _) = normalising_scale(greater(size, f64::MIN_POSITIVE));
            region.centre + away * inverse * (FAR / region.scale)
        } else {
            point
        };
        // A region of one point has a scale of 1. Clamping huge coordinates keeps distances to its box lower bounds.
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

    /// Test a triangle. Return true if it is the nearest so far.
    #[inline(always)]
    pub fn offer(&mut self, primitive: u32, corners: [DVec3; 3]) -> bool {
        // Most triangles of a leaf are too far, which their boxes show at a quarter of the cost.
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

    /// Squared distances to boxes, given by axis and side, in their units. They never exceed those to the triangles
    /// inside, as computed by [`Search::offer`]. Infinite for empty boxes.
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

    /// Nothing at a greater squared distance than this is as near as the current result.
    #[inline(always)]
    pub fn limit(&self) -> f64 {
        limit(self.distance * self.scale)
    }

    /// The result.
    #[inline(always)]
    pub fn finish(&self) -> Nearest {
        if self.primitive == u32::MAX {
            return Nearest::MISS;
        }
        let uv = nearest_point(self.corners, self.point).uv;
        let position = point_of(self.corners, uv);
        let distance = if self.point == self.given { self.distance } else { length(self.given - position) };
        // Distances that overflow count as misses.
        if distance <= self.most && distance.is_finite() {
            Nearest { distance, position, uv, primitive: self.primitive, inner: 0 }
        } else {
            Nearest::MISS
        }
    }
}

/// An f32 test that rejects triangles of a leaf by distance, in parallel.
///
/// For any vector w, a triangle is at least as far as the minimum of w · (corner − point) / |w|. With w toward the
/// triangle's center this is tight if the triangle is small relative to its distance.
///
/// The bound. Let ε = 2⁻²⁴ and L bound |point| + |corner| in every coordinate. The point errs by εL, a corner by up to
/// 4εL if it is stored as an edge in box units, and their difference by εL. The dot product with w has three terms with
/// at most three roundings each. So it errs by 9εL·(|w₁| + |w₂| + |w₃|) and the distance by 9√3·εL < 15.6εL. 16εL is
/// allowed, and in box units 32εL. The vector w is exact by definition; squares err by 8ε of themselves, for which 16ε
/// are allowed.
#[derive(Clone, Copy, Debug)]
pub struct LeafTest {
    /// In the units of the leaves.
    point: [f32; 3],
    /// The error allowed for.
    slack: f64,
    /// The factor from the scene's units to those of leaves.
    scale: f64,
}

impl LeafTest {
    const STEP: f64 = 1.0 / (1u32 << 20) as f64;

    /// Prepare a search for leaves with corners in the scene's units (`as_they_are`) or in box units.
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

    /// The squared distance beyond which triangles are rejected.
    #[inline(always)]
    pub fn limit(&self, search: &Search) -> f32 {
        let distance = search.distance * self.scale + self.slack;
        (distance * distance * (1.0 + Self::STEP)) as f32
    }

    /// The lanes with triangles that may be near enough.
    // Written out axis by axis: closures between here and the kernel's entry are not always compiled for its SIMD
    // level.
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
        // Tiny distances, which underflow, are not rejected.
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

/// The squared distance of two intervals.
#[inline(always)]
fn gap(lower: f64, upper: f64, low: f64, high: f64) -> f64 {
    let gap = greater(greater(lower - high, low - upper), 0.0);
    gap * gap
}

/// The squared distance beyond which nothing is as near as `distance`. It is padded for rounding, and has a minimum
/// below which squares underflow.
#[inline(always)]
fn limit(distance: f64) -> f64 {
    const ROOM: f64 = 1.0 + 1.0 / (1u64 << 48) as f64;
    greater(distance * distance * ROOM, f64::MIN_POSITIVE)
}

/// The maximum distance of point `i`, given once for all or per point.
#[inline(always)]
pub fn of(max_distances: &[f64], i: usize) -> f64 {
    if max_distances.len() == 1 { max_distances[0] } else { max_distances[i] }
}
