//! The state of a nearest-point query, and conservative distance tests.
//!
//! Boxes are stored in f32, in box units ([`Region`]), rounded outward, and so are points for tests of boxes. With u =
//! 2⁻⁵³ and P the point's largest coordinate in box units, the point errs by 2uP, and a box by 2u for its rounding to
//! box units. A triangle's own distance errs by 2⁻⁴⁹ of the distance to its farthest corner, which is at most
//! 16u·√3·(P + 2). The point is widened by 64u·(P + 2) along every axis, so that the distance to a box never exceeds
//! the computed distances to its triangles.
//!
//! Along a tree's own axes ([`Axes`]) all lengths are halved, and P is the point's largest coordinate there, at most
//! 2√3·P in box units. So a triangle's distance errs by 8u·√3·(2√3·P + 2), the point by 5u·2√3·P, and a box by 10u.
//! Distances of up to √3·(P + √3) there are half the true ones to within 8u of themselves. In all that is less than
//! 80u·(P + 2), and the point is widened by 128u·(P + 2).

mod leaf_bounds;

pub use leaf_bounds::{Brackets, LeafBounds};
use raywright_base::math::robust::{greater, lesser, normalising_scale};
use raywright_base::math::{Axes, DVec3, Region};
use raywright_base::simd::Simd;
use raywright_shapes::triangle::{NearestPoint, length, nearest_point, point_of};

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
    /// In box units by axis, rounded down and up.
    single: [[f32; 2]; 3],
    /// Maximum distance.
    most: f64,
    /// The nearest triangle so far.
    distance: f64,
    primitive: u32,
    corners: [DVec3; 3],
    uv: [f64; 2],
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
        let [x, y, z] = region.to_box_along(axes, searched).to_array();
        let [x, y, z] = [finite(x), finite(y), finite(z)];
        let (widths, scale) = if axes.is_some() { (2.0, Axes::SCALE * region.scale) } else { (1.0, region.scale) };
        let pad = widths * PAD * (greater(greater(x.abs(), y.abs()), z.abs()) + 2.0);
        let distance = if is_far { f64::INFINITY } else { max_distance };
        Some(Self {
            given: point,
            point: searched,
            single: [
                [outward(x - pad, -1.0), outward(x + pad, 1.0)],
                [outward(y - pad, -1.0), outward(y + pad, 1.0)],
                [outward(z - pad, -1.0), outward(z + pad, 1.0)],
            ],
            most: max_distance,
            distance,
            primitive: u32::MAX,
            corners: [DVec3::ZERO; 3],
            uv: [0.0; 2],
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
        let NearestPoint { distance, uv } = nearest_point(corners, self.point);
        let is_nearer = distance < self.distance || (distance == self.distance && primitive < self.primitive);
        if is_nearer {
            (self.distance, self.primitive, self.corners, self.uv) = (distance, primitive, corners, uv);
            self.square = limit(distance);
        }
        is_nearer
    }

    /// Squared distances to boxes, given by axis and side, in their units. They never exceed those to the triangles
    /// inside, as computed by [`Search::offer`]. Infinite for empty boxes.
    ///
    /// In f32, a gap errs by 2⁻²⁴ of itself, its square by three times that, and the sum by two more roundings. For
    /// these and for the rounding of [`Search::limit`], `ROOM` is subtracted.
    #[inline(always)]
    pub fn squares<const N: usize, S: Simd<N>>(&self, simd: S, planes: &[[[f32; N]; 2]; 3]) -> S::F32 {
        let mut squares = simd.splat(0.0);
        for axis in 0..3 {
            let (lower, upper) = (simd.load(&planes[axis][0]), simd.load(&planes[axis][1]));
            let [low, high] = self.single[axis];
            let gap = simd.max(simd.sub(lower, simd.splat(high)), simd.sub(simd.splat(low), upper));
            let gap = simd.max(gap, simd.splat(0.0));
            squares = simd.mul_add(gap, gap, squares);
        }
        simd.mul(squares, simd.splat(1.0 - ROOM))
    }

    /// The position of the current result.
    #[inline(always)]
    pub fn position(&self) -> DVec3 {
        point_of(self.corners, self.uv)
    }

    /// The result.
    #[inline(always)]
    pub fn finish(&self) -> Nearest {
        if self.primitive == u32::MAX {
            return Nearest::MISS;
        }
        let (uv, position) = (self.uv, self.position());
        let distance = if self.point == self.given { self.distance } else { length(self.given - position) };
        // Distances that overflow count as misses.
        if distance <= self.most && distance.is_finite() {
            Nearest { distance, position, uv, primitive: self.primitive, inner: 0 }
        } else {
            Nearest::MISS
        }
    }
}

/// What is subtracted from squared distances in f32, and added to their limits.
const ROOM: f32 = 1.0 / (1u32 << 20) as f32;

/// Clamp to numbers whose sums are finite.
#[inline(always)]
fn finite(x: f64) -> f64 {
    greater(lesser(x, 1e300), -1e300)
}

/// Round to f32, certainly down or up as `way` is −1 or 1.
#[inline(always)]
fn outward(x: f64, way: f32) -> f32 {
    let x = greater(lesser(x, f64::from(f32::MAX)), f64::from(f32::MIN)) as f32;
    x + way * (x.abs() / (1u32 << 22) as f32 + f32::MIN_POSITIVE)
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
