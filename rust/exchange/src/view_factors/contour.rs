//! The closed form for two nearby polygons, as a double contour integral:
//!
//! A₁ F₁₂ = 1/(2π) ∮∮ ln r dp·dq
//!
//! (Schröder and Hanrahan, "On the Form Factor Between Two Polygons", 1993). The inner integral along an edge has a
//! closed form (Mitalas and Stephenson 1966); the outer one uses Gauss-Legendre rules. Along its edge the integrand is
//! analytic except near three points: beside the two ends of the other edge, and beside that edge's line. Their
//! distances from the real axis are known. An interval uses the rule whose error they bound (Trefethen, "Approximation
//! Theory and Approximation Practice", 2013, theorem 19.3), or is split near them.

use super::facet::Facet;
use raywright_base::math::DVec3;
use raywright_base::math::gauss::gauss;
use std::f64::consts::TAU;
use std::sync::OnceLock;

/// Maximum number of points of a rule.
const MOST: usize = 16;

/// The area of `one` times its view factor to `other`, if each is wholly in front of the other.
pub fn contour(one: &Facet, other: &Facet) -> f64 {
    let origin = one.corners[0];
    // An exact power of two: lengths near 1 have small logarithms.
    let scale = 2f64.powi(-((one.radius.max(other.radius)).log2().round() as i32));
    let [p, q] = [one, other].map(|facet| facet.corners.map(|corner| (corner - origin) * scale));
    let mut sum = 0.0;
    for i in 0..3 {
        for j in 0..3 {
            sum += edges([p[i], p[(i + 1) % 3]], [q[j], q[(j + 1) % 3]]);
        }
    }
    sum / (TAU * scale * scale)
}

/// The position along an edge of a singularity of the inner integral, and its distance from the real axis.
#[derive(Clone, Copy)]
struct Singularity {
    at: f64,
    off: f64,
}

/// ∫∫ ln r dp·dq over two edges.
fn edges(p: [DVec3; 2], q: [DVec3; 2]) -> f64 {
    let (along, to) = (p[1] - p[0], q[1] - q[0]);
    let (a, b) = (along.length(), to.length());
    if a == 0.0 || b == 0.0 {
        return 0.0;
    }
    let (u, v) = (along / a, to / b);
    let cosine = u.dot(v);
    if cosine == 0.0 {
        return 0.0;
    }
    let ends = q.map(|end| {
        let way = end - p[0];
        let at = way.dot(u);
        Singularity { at, off: (way - u * at).length() }
    });
    if ends.iter().all(|end| end.off <= 1e-15 * (a + b + end.at.abs())) {
        return cosine * collinear(a, ends.map(|end| end.at));
    }
    let normal = u.cross(v);
    let square = normal.length_squared();
    let mut singular = [ends[0], ends[1], Singularity { at: 0.0, off: f64::INFINITY }];
    if square > 1e-16 {
        let way = q[0] - p[0];
        let at = way.cross(v).dot(normal) / square;
        let foot = way.cross(u).dot(normal) / square;
        if foot > -b && foot < 2.0 * b {
            singular[2] = Singularity { at, off: way.dot(normal).abs() / square };
        }
    }
    let inner = |s: f64| logarithms(q, v, b, p[0] + u * s);
    cosine * graded(a, &singular, &inner)
}

/// ∫ ln |s − t| over [0, a] and an interval of the same line.
fn collinear(a: f64, [from, to]: [f64; 2]) -> f64 {
    let second = |x: f64| if x == 0.0 { 0.0 } else { 0.5 * x * x * (x.abs().ln() - 1.5) };
    // The ends are in the other edge's direction, and its length counts as positive.
    let whole = second(to) - second(to - a) - second(from) + second(from - a);
    if to >= from { whole } else { -whole }
}

/// ∫ ln |x − q| along an edge of length `b` and direction `v`.
#[inline]
fn logarithms(q: [DVec3; 2], v: DVec3, b: f64, x: DVec3) -> f64 {
    let (first, last) = (q[0] - x, q[1] - x);
    let (from, to) = (first.dot(v), last.dot(v));
    // From the nearer end, which loses fewer digits.
    let nearer = if from.abs() < to.abs() { first } else { last };
    let height = nearer.cross(v).length();
    let term = |t: f64, square: f64| if square > 0.0 { 0.5 * t * square.ln() } else { 0.0 };
    let arc = if height > 0.0 { height * (height * (to - from)).atan2(height * height + from * to) } else { 0.0 };
    term(to, last.length_squared()) - term(from, first.length_squared()) - b + arc
}

/// ∫ over [0, length] of a function with the given singularities.
fn graded(length: f64, singular: &[Singularity; 3], inner: &impl Fn(f64) -> f64) -> f64 {
    static RULES: OnceLock<Vec<Vec<(f64, f64)>>> = OnceLock::new();
    let rules = RULES.get_or_init(|| (0..=MOST).map(gauss).collect());
    let mut open = [[0.0; 2]; 96];
    open[0] = [0.0, length];
    let mut left = 1;
    let mut sum = 0.0;
    while left > 0 {
        left -= 1;
        let [from, to] = open[left];
        let (half, middle) = (0.5 * (to - from), 0.5 * (from + to));
        // The sum of semi-axes of the ellipse about the interval's ends through the nearest singularity.
        let (mut least, mut nearest) = (f64::INFINITY, singular[0]);
        for place in singular.iter().filter(|place| place.off.is_finite()) {
            let (x, y) = ((place.at - middle) / half, place.off / half);
            let axis = 0.5 * ((x - 1.0).hypot(y) + (x + 1.0).hypot(y));
            if axis < least {
                (least, nearest) = (axis, *place);
            }
        }
        let rho = least + (least * least - 1.0).max(0.0).sqrt();
        // ρ to the power −2n is 10⁻¹³.
        let points = if rho > 1.0 { (15.0 / rho.ln()).ceil() } else { f64::INFINITY };
        // The error next to a singularity is of the order of the squared interval.
        let is_last = to - from < 1e-7 * length || left + 2 > open.len();
        if points <= MOST as f64 || is_last {
            let points = if is_last { 6 } else { (points as usize).max(2) };
            let part: f64 = rules[points].iter().map(|&(t, weight)| weight * inner(from + (to - from) * t)).sum();
            sum += (to - from) * part;
            continue;
        }
        let quarter = 0.25 * (to - from);
        let at = nearest.at;
        let cut = if at <= from {
            from + quarter
        } else if at >= to {
            to - quarter
        } else {
            // Not too close to an end, so that both parts have a length.
            at.clamp(from + 1e-3 * quarter, to - 1e-3 * quarter)
        };
        open[left] = [from, cut];
        open[left + 1] = [cut, to];
        left += 2;
    }
    sum
}
