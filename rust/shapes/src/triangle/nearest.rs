//! The closest point of a triangle (cf. Ericson, "Real-Time Collision Detection", 2005, section 5.1).
//!
//! Ericson classifies the closest feature, face, edge or corner, by dot products of edges, which is unreliable for
//! slivers because of cancellation. Here the face is closest if the point projects inside all three edges, decided by
//! the signs of the same cross products that give the distances to the edges. Otherwise it is the closest of the three
//! edges, each treated as a segment. So degenerate triangles need no special case: they are their edges, and those are
//! segments or points.
//!
//! The bound. Let F be the distance to the farthest corner. The distance errs by less than 2⁻⁴⁹·F. It is 0 on corners
//! and edges if the differences of the corners and the point are exact, as for f32 numbers of similar size. Within a
//! face it is 0 if products of three such differences are exact too, as for small integers. All is computed in units of
//! F, so coordinates may be of any size. Cross products keep nearly all digits despite cancellation (Kahan; Jeannerod,
//! Louvet and Muller 2013), so the plane of a sliver is as accurate as any. Lengths below 2⁻⁴⁰⁰·F are lost: such an
//! edge is a point, and such an area zero.

use raywright_base::math::DVec3;
use raywright_base::math::robust::{greater, lesser, normalising_scale};

/// The closest point of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestPoint {
    /// The distance; infinite if it overflows an f64.
    pub distance: f64,
    /// Barycentric weights of the second and the third corner.
    pub uv: [f64; 2],
}

/// Squares below this, 2⁻⁸⁰⁰, may have lost digits to underflow.
const SMALL_SQUARE: f64 = f64::from_bits((1023 - 800) << 52);

/// Maximum coordinate for which differences and their differences are finite.
const LARGE: f64 = f64::MAX / 8.0;

/// Find the closest point of a triangle with finite coordinates. The distance to an edge shared by two triangles has
/// the same bits for both, in either orientation.
#[inline(always)]
pub fn nearest_point(corners: [DVec3; 3], point: DVec3) -> NearestPoint {
    let [a, b, c] = corners;
    let (to_a, to_b, to_c) = (a - point, b - point, c - point);
    let largest = to_a.abs().max(to_b.abs()).max(to_c.abs());
    let largest = greater(greater(largest.x, largest.y), largest.z);
    // Infinite if a difference is.
    if largest > LARGE {
        return nearest_far_point(corners, point);
    }
    let (scale, inverse) = normalising_scale(greater(largest, f64::MIN_POSITIVE));
    let to = [to_a * scale, to_b * scale, to_c * scale];
    // The edge opposite each corner, in consistent orientation.
    let along = [(c - b) * scale, (a - c) * scale, (b - a) * scale];
    let normal = cross(along[2], along[0]);
    let squares = [to[0].length_squared(), to[1].length_squared(), to[2].length_squared()];
    let edges = [
        Edge::new(&corners, &to, &squares, along[0], [1, 2]),
        Edge::new(&corners, &to, &squares, along[1], [2, 0]),
        Edge::new(&corners, &to, &squares, along[2], [0, 1]),
    ];

    let area = normal.length_squared();
    let sides = [normal.dot(edges[0].moment), normal.dot(edges[1].moment), normal.dot(edges[2].moment)];
    if area >= SMALL_SQUARE && sides[0] > 0.0 && sides[1] > 0.0 && sides[2] > 0.0 {
        // From the nearest corner, whose coordinates err least.
        let nearest = if squares[0] <= squares[1] { 0 } else { 1 };
        let nearest = if squares[nearest] <= squares[2] { nearest } else { 2 };
        let distance = dot(normal, to[nearest]).abs() / area.sqrt() * inverse;
        return NearestPoint { distance, uv: weights(&to, &along, &sides, area) };
    }
    let nearest = if edges[2].square <= edges[1].square { 2 } else { 1 };
    let nearest = if edges[nearest].square <= edges[0].square { nearest } else { 0 };
    let edge = &edges[nearest];
    NearestPoint { distance: edge.distance() * inverse, uv: [edge.weights[1], edge.weights[2]] }
}

/// The weights of the second and the third corner if the face is closest, given all weights times `area`.
///
/// The weights of a sliver are uncertain, but the position along its longest edge is not. So the weight of the corner
/// opposite that edge is limited to the triangle's extent at that position. The weights of the edge's ends follow from
/// both.
#[inline(always)]
fn weights(to: &[DVec3; 3], along: &[DVec3; 3], sides: &[f64; 3], area: f64) -> [f64; 2] {
    let lengths = along.map(|e| e.length_squared());
    let k = if lengths[0] >= lengths[1] { 0 } else { 1 };
    let k = if lengths[k] >= lengths[2] { k } else { 2 };
    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
    // The positions of the point and of corner k along the edge from i to j.
    let place = lesser(greater(-to[i].dot(along[k]) / lengths[k], 0.0), 1.0);
    let top = lesser(greater(-along[j].dot(along[k]) / lengths[k], 0.0), 1.0);
    let reach = if place < top {
        place / top
    } else if place > top {
        (1.0 - place) / (1.0 - top)
    } else {
        1.0
    };
    let mut weights = [0.0; 3];
    weights[k] = lesser(sides[k] / area, reach);
    weights[j] = lesser(greater(place - weights[k] * top, 0.0), 1.0 - weights[k]);
    weights[i] = 1.0 - weights[k] - weights[j];
    [weights[1], weights[2]]
}

/// [`nearest_point`] for coordinates whose differences may overflow.
#[cold]
#[inline(never)]
fn nearest_far_point(corners: [DVec3; 3], point: DVec3) -> NearestPoint {
    const LESS: f64 = 1.0 / 32.0;
    let nearest = nearest_point(corners.map(|c| c * LESS), point * LESS);
    NearestPoint { distance: nearest.distance / LESS, ..nearest }
}

/// The point of a triangle with weights `uv` for its second and third corner; exactly a corner if it has all the
/// weight.
pub fn point_of(corners: [DVec3; 3], [u, v]: [f64; 2]) -> DVec3 {
    let weights = [1.0 - u - v, u, v];
    let heaviest = if weights[0] >= weights[1] { 0 } else { 1 };
    let heaviest = if weights[heaviest] >= weights[2] { heaviest } else { 2 };
    let (i, j) = ((heaviest + 1) % 3, (heaviest + 2) % 3);
    // Relative to the corner of greatest weight, so that far from the origin only one sum is rounded. Halved, since
    // differences may overflow.
    let base = corners[heaviest];
    let from_base = |k: usize| (corners[k] / 2.0 - base / 2.0) * weights[k];
    base + (from_base(i) + from_base(j)) * 2.0
}

/// An edge relative to the point.
#[derive(Clone, Copy)]
struct Edge {
    /// The cross product of its ends. Its component along the normal is the weight of the opposite corner.
    moment: DVec3,
    /// The squared distance.
    square: f64,
    /// The numerator and denominator of the squared distance: a vector's square over this number.
    vector: DVec3,
    divisor: f64,
    /// The corners' weights at the closest point of the edge.
    weights: [f64; 3],
}

impl Edge {
    /// The edge `along` from corner `i` to corner `j`.
    #[inline(always)]
    fn new(corners: &[DVec3; 3], to: &[DVec3; 3], squares: &[f64; 3], along: DVec3, [i, j]: [usize; 2]) -> Self {
        // From its nearer end, whose coordinates err least; if both are equally near, from the same one in either
        // orientation.
        let first =
            squares[i] < squares[j] || (squares[i] == squares[j] && corners[i].to_array() <= corners[j].to_array());
        let (near, far, out) = if first { (i, j, along) } else { (j, i, -along) };
        let moment = cross(to[near], along);
        let length = along.length_squared();
        let forward = -to[near].dot(out);
        let mut weights = [0.0; 3];
        if forward > 0.0 && forward < length && length >= SMALL_SQUARE {
            let part = forward / length;
            (weights[near], weights[far]) = (1.0 - part, part);
            Self { moment, square: moment.length_squared() / length, vector: moment, divisor: length, weights }
        } else {
            // For an edge that is short relative to its distance, the other end may turn out to be the nearer one.
            let end = if forward > 0.0 && length >= SMALL_SQUARE { far } else { near };
            weights[end] = 1.0;
            Self { moment, square: squares[end], vector: to[end], divisor: 1.0, weights }
        }
    }

    #[inline(always)]
    fn distance(&self) -> f64 {
        if self.square >= SMALL_SQUARE { self.square.sqrt() } else { length(self.vector) / self.divisor.sqrt() }
    }
}

/// The length of a vector of any size.
#[inline]
pub fn length(v: DVec3) -> f64 {
    let largest = v.abs().max_element();
    if !largest.is_finite() {
        return f64::INFINITY;
    }
    let (scale, inverse) = normalising_scale(greater(largest, f64::MIN_POSITIVE));
    (v * scale).length() * inverse
}

/// `a × b`, each coordinate to within 1.5 ulp.
#[inline(always)]
pub(super) fn cross(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::new(difference(a.y, b.z, a.z, b.y), difference(a.z, b.x, a.x, b.z), difference(a.x, b.y, a.y, b.x))
}

/// `a · b − c · d`, by Kahan's method.
#[inline(always)]
fn difference(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let product = c * d;
    let lost = c.mul_add(-d, product);
    a.mul_add(b, -product) + lost
}

/// `a · b` as in twice the working precision (Ogita, Rump and Oishi 2005).
#[inline(always)]
fn dot(a: DVec3, b: DVec3) -> f64 {
    let (x, y, z) = (a.x * b.x, a.y * b.y, a.z * b.z);
    let lost = a.x.mul_add(b.x, -x) + a.y.mul_add(b.y, -y) + a.z.mul_add(b.z, -z);
    let (xy, lost_xy) = sum(x, y);
    let (xyz, lost_xyz) = sum(xy, z);
    xyz + (lost_xy + lost_xyz + lost)
}

/// A rounded sum and its rounding error (Knuth 1969).
#[inline(always)]
fn sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}
