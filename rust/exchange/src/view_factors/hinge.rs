//! View factors of two nearly coplanar triangles. They exchange so little that contour integrals cancel; here all terms
//! are positive.
//!
//! The planes meet in a line, and the triangles lie on either side of it. With the distance u or v of a point from that
//! line, t along it, and the angle φ between the half-planes,
//!
//! A₁ F₁₂ = sin²φ/π ∫∫ u v ∫∫ ((t₁ − t₂)² + s²)⁻² dt₁ dt₂ du dv, s² = u² + v² − 2uv cos φ.
//!
//! The inner two integrals have a closed form (Feingold, "Radiation-Interchange Configuration Factors Between Various
//! Selected Plane Surfaces", 1966, has it for rectangles). The outer two use Gauss-Legendre rules on adaptively halved
//! rectangles. Next to a corner on the line, where 1/s³ is not smooth, the Duffy transformation replaces one of the
//! axes by lines through that corner (Duffy, "Quadrature over a Pyramid or Cube of Integrands with a Singularity at a
//! Vertex", 1982).

use super::facet::Facet;
use raywright_base::math::DVec3;
use raywright_base::math::gauss::gauss;
use std::collections::VecDeque;
use std::f64::consts::PI;
use std::sync::OnceLock;

/// Points of a rule per axis.
const POINTS: usize = 8;

/// Relative tolerance of adaptive halving: rectangles whose halves change the total by less are accepted. For smooth
/// integrands the error is far smaller, since the halves of a convergent rule are off by less than a hundredth of the
/// change.
const ENOUGH: f64 = 1e-11;

/// Maximum depth of halving.
const MOST_CUTS: u32 = 96;

/// Maximum number of halved rectangles per pair, larger rectangles first. With rounding errors between touching
/// corners, halving never converges.
const MOST_HALVED: u32 = 1 << 9;

/// Slices are split if their far end exceeds this multiple of their start, or of the other's end.
const UNEVEN: f64 = 8.0;

/// Intervals shorter than this fraction of their distance use a quadrature rule, since the closed form would cancel.
const SHORT: f64 = 0.1;

/// Points of that rule. The nearest singularity is on an ellipse with ρ ≈ 40, so the error is about 40⁻¹⁰.
const SHORT_POINTS: usize = 5;

/// Distance from the line, in radii, beyond which the planes count as parallel: such distances would cancel.
const FARTHEST: f64 = 1000.0;

/// The area of `one` times its view factor to `other`, if each is wholly in front of the other. `None` if their planes
/// are nearly parallel. `heights` are those of the other's corners above the plane of `one`, and vice versa.
pub fn hinge(one: &Facet, other: &Facet, heights: [[f64; 3]; 2]) -> Option<f64> {
    let scale = 2f64.powi(-((one.radius.max(other.radius)).log2().round() as i32));
    let slopes = [slope(one, heights[1]), slope(other, heights[0])];
    let [ours, theirs] = slopes.map(DVec3::length);
    // Both lengths are the sine of the angle; the one from larger heights has lost fewer digits.
    let most = |of: [f64; 3]| of.into_iter().fold(0.0, f64::max);
    if heights.iter().any(|&of| most(of) == 0.0) {
        return Some(0.0);
    }
    let is_first = most(heights[1]) >= most(heights[0]);
    let reach = FARTHEST * one.radius.max(other.radius) * ours.min(theirs);
    if most(heights[0]).max(most(heights[1])) >= reach {
        return None;
    }
    let (sine, along) =
        if is_first { (ours, one.normal.cross(slopes[0])) } else { (theirs, other.normal.cross(slopes[1])) };
    let along = along / sine;
    let origin = one.corners[0];
    let slices = |facet: &Facet, heights: [f64; 3]| {
        let place = |i: usize| [(facet.corners[i] - origin).dot(along) * scale, heights[i] / sine * scale];
        slices([place(0), place(1), place(2)])
    };
    let (ones, others) = (slices(one, heights[1]), slices(other, heights[0]));
    let bend = Bend::new(one.normal, other.normal);
    let mut squares = Vec::with_capacity(16);
    for from in ones.iter().flatten() {
        for to in others.iter().flatten() {
            Slices { from: *from, to: *to, bend: &bend }.graded(&mut squares);
        }
    }
    Some(sine * sine / PI * sum(&squares) / (scale * scale))
}

/// The gradient of the heights of a triangle's corners within its plane.
fn slope(facet: &Facet, [a, b, c]: [f64; 3]) -> DVec3 {
    let [first, second] = [1, 2].map(|i| facet.corners[i] - facet.corners[0]);
    let unit = 1.0 / facet.radius;
    let [first, second] = [first * unit, second * unit];
    let turned = second.cross(facet.normal) * ((b - a) * unit) + facet.normal.cross(first) * ((c - a) * unit);
    turned / first.cross(second).length()
}

/// The angle between two half-planes.
struct Bend {
    /// The cosine of the normals' angle, −cos φ.
    cosine: f64,
    /// The accurate difference of its magnitude from 1.
    short: f64,
}

impl Bend {
    fn new(one: DVec3, other: DVec3) -> Self {
        let cosine = one.dot(other);
        let short =
            if cosine > 0.0 { 0.5 * (one - other).length_squared() } else { 0.5 * (one + other).length_squared() };
        Self { cosine, short }
    }

    /// The distance, across the line, of two points at the distances u and v from it.
    #[inline]
    fn across(&self, u: f64, v: f64) -> f64 {
        let square = if self.cosine > 0.0 {
            (u + v) * (u + v) - 2.0 * u * v * self.short
        } else {
            (u - v) * (u - v) + 2.0 * u * v * self.short
        };
        square.sqrt()
    }
}

/// A part of a triangle between two distances from the line, with an interval along it that changes linearly.
#[derive(Clone, Copy, Debug)]
struct Slice {
    start: f64,
    end: f64,
    /// The intervals at both ends.
    from: [f64; 2],
    to: [f64; 2],
}

impl Slice {
    fn width(&self) -> f64 {
        self.end - self.start
    }

    /// Split at a distance: the nearer part and the rest.
    fn cut(&self, at: f64) -> [Self; 2] {
        let (_, middle) = self.at((at - self.start) / self.width());
        [Self { end: at, to: middle, ..*self }, Self { start: at, from: middle, ..*self }]
    }

    /// The distance and the interval at a fraction between both ends.
    #[inline]
    fn at(&self, share: f64) -> (f64, [f64; 2]) {
        let between = |a: f64, b: f64| a + (b - a) * share;
        (between(self.start, self.end), [between(self.from[0], self.to[0]), between(self.from[1], self.to[1])])
    }
}

/// The slices of a triangle, given by its corners' positions along the line and distances from it.
fn slices(mut corners: [[f64; 2]; 3]) -> [Option<Slice>; 2] {
    corners.sort_by(|a, b| a[1].total_cmp(&b[1]));
    let [low, middle, high] = corners;
    if low[1] == high[1] {
        return [None, None];
    }
    let share = (middle[1] - low[1]) / (high[1] - low[1]);
    let across = low[0] + (high[0] - low[0]) * share;
    let wide = [across.min(middle[0]), across.max(middle[0])];
    let slice =
        |start: f64, end: f64, from: [f64; 2], to: [f64; 2]| (end > start).then_some(Slice { start, end, from, to });
    [slice(low[1], middle[1], [low[0]; 2], wide), slice(middle[1], high[1], wide, [high[0]; 2])]
}

/// A slice of each triangle.
#[derive(Clone, Copy)]
struct Slices<'a> {
    from: Slice,
    to: Slice,
    bend: &'a Bend,
}

impl<'a> Slices<'a> {
    /// Divide into parts for integration, so that no slice extends much farther from the line than the other, or than
    /// its own start.
    fn graded(self, found: &mut Vec<Integrand<'a>>) {
        let Self { from, to, .. } = self;
        let cut = |slice: &Slice, least: f64| {
            (slice.end > 2.0 * UNEVEN * least).then(|| slice.cut(least.max(slice.end / UNEVEN)))
        };
        if let Some(parts) = cut(&from, from.start.max(to.end)) {
            parts.into_iter().for_each(|from| Self { from, ..self }.graded(found));
        } else if let Some(parts) = cut(&to, to.start.max(from.end)) {
            parts.into_iter().for_each(|to| Self { to, ..self }.graded(found));
        } else if from.start + to.start < from.width() + to.width() {
            let near = self.layer() / (from.width() + to.width());
            found.extend([Fan::First, Fan::Second].map(|fan| Integrand { both: self, fan, near }));
        } else {
            found.push(Integrand { both: self, fan: Fan::None, near: 1.0 });
        }
    }

    /// The width of a possible boundary layer at the start of both slices: the least nonzero distance between their
    /// ends there.
    fn layer(&self) -> f64 {
        let (a, b) = (self.from.from, self.to.from);
        let ends = [a[0] - b[0], a[0] - b[1], a[1] - b[0], a[1] - b[1], self.from.start + self.to.start];
        ends.into_iter().map(f64::abs).filter(|&way| way > 0.0).fold(f64::INFINITY, f64::min)
    }

    /// u v ∫∫ ((t₁ − t₂)² + s²)⁻² dt₁ dt₂ at a fraction of each slice, times the slices' widths.
    #[inline]
    fn exchanged(&self, first: f64, second: f64) -> f64 {
        let ((u, one), (v, other)) = (self.from.at(first), self.to.at(second));
        u * v * along(one, other, self.bend.across(u, v)) * self.from.width() * self.to.width()
    }
}

/// The lines through the corner at distance zero that a square represents.
#[derive(Clone, Copy)]
enum Fan {
    /// None: no transformation.
    None,
    /// Those that leave through the far end of the first slice.
    First,
    /// Those that leave through the far end of the second slice.
    Second,
}

/// An integrand over the unit square.
#[derive(Clone, Copy)]
struct Integrand<'a> {
    both: Slices<'a>,
    fan: Fan,
    /// Distance from the fan's corner within which it is always halved.
    near: f64,
}

impl Integrand<'_> {
    #[inline]
    fn at(&self, x: f64, y: f64) -> f64 {
        match self.fan {
            Fan::None => self.both.exchanged(x, y),
            Fan::First => x * self.both.exchanged(x, x * y),
            Fan::Second => x * self.both.exchanged(x * y, x),
        }
    }

    /// Integrate over a rectangle in the square with a rule.
    fn over(&self, area: &Rectangle, rule: &[(f64, f64)]) -> f64 {
        let ([x, y], [width, height]) = (area.corner, area.sides);
        let row = |&(s, weight): &(f64, f64)| {
            let cells = rule.iter().map(|&(t, weight)| weight * self.at(x + width * s, y + height * t));
            weight * cells.sum::<f64>()
        };
        width * height * rule.iter().map(row).sum::<f64>()
    }
}

/// A rectangle in the unit square.
#[derive(Clone, Copy)]
struct Rectangle {
    corner: [f64; 2],
    sides: [f64; 2],
}

impl Rectangle {
    /// Its halves along one axis.
    fn halves(&self, axis: usize) -> [Self; 2] {
        let mut halves = [*self; 2];
        for half in &mut halves {
            half.sides[axis] *= 0.5;
        }
        halves[1].corner[axis] += halves[1].sides[axis];
        halves
    }
}

/// The integral over some squares.
fn sum(parts: &[Integrand]) -> f64 {
    static RULE: OnceLock<Vec<(f64, f64)>> = OnceLock::new();
    let rule = RULE.get_or_init(|| gauss(POINTS));
    let whole = Rectangle { corner: [0.0; 2], sides: [1.0; 2] };
    let mut open: VecDeque<_> = parts.iter().map(|part| (part, whole, part.over(&whole, rule), MOST_CUTS)).collect();
    let enough = ENOUGH * open.iter().map(|square| square.2).sum::<f64>();
    let (mut found, mut halved) = (0.0, 0);
    while let Some((part, area, before, cuts)) = open.pop_front() {
        let halves = [0, 1].map(|axis| area.halves(axis).map(|half| (half, part.over(&half, rule))));
        let [across, up] = halves.map(|[low, high]| low.1 + high.1 - before);
        let is_next = area.corner[0] == 0.0 && area.sides[0] > part.near;
        if (across.abs() <= enough && up.abs() <= enough && !is_next) || cuts == 0 || halved == MOST_HALVED {
            // Add the corrections from halving along both axes.
            found += before + across + up;
        } else {
            halved += 1;
            let halves = halves[usize::from(!is_next && up.abs() > across.abs())];
            open.extend(halves.map(|(half, value)| (part, half, value, cuts - 1)));
        }
    }
    found
}

/// ∫∫ ((t₁ − t₂)² + s²)⁻² over two intervals.
///
/// The second integral of the integrand is x atan(x/s)/(2s³) = π|x|/(4s³) − 1/(2s²) + k(|x|). In the sum over four
/// ends, the first terms add up to the overlap of the intervals, and the second ones to zero. Only [`tail`], which is
/// small for large x, is subtracted.
#[inline]
fn along([a, b]: [f64; 2], [c, d]: [f64; 2], s: f64) -> f64 {
    let common = (b.min(d) - a.max(c)).max(0.0);
    let apart = (a - d).max(c - b).max(0.0);
    if (b - a).max(d - c) < SHORT * s.hypot(apart) {
        return by_points([a, b], [c, d], s * s);
    }
    let tails = tail((b - c).abs(), s) - tail((a - c).abs(), s) - tail((b - d).abs(), s) + tail((a - d).abs(), s);
    0.5 * PI * common / (s * s * s) + tails
}

/// (s − x atan(s/x))/(2s³).
#[inline]
fn tail(x: f64, s: f64) -> f64 {
    if s > 0.25 * x {
        return (s - x * s.atan2(x)) / (2.0 * s * s * s);
    }
    let square = (s / x) * (s / x);
    let series = (0..12).rev().fold(0.0, |sum, m| 1.0 / f64::from(2 * m + 3) - square * sum);
    series / (2.0 * x * x)
}

/// The same by a quadrature rule.
fn by_points([a, b]: [f64; 2], [c, d]: [f64; 2], square: f64) -> f64 {
    static RULE: OnceLock<Vec<(f64, f64)>> = OnceLock::new();
    let rule = RULE.get_or_init(|| gauss(SHORT_POINTS));
    let mut sum = 0.0;
    for &(x, wx) in rule {
        let first = a + (b - a) * x;
        for &(y, wy) in rule {
            let way = first - (c + (d - c) * y);
            let long = way * way + square;
            sum += wx * wy / (long * long);
        }
    }
    sum * (b - a) * (d - c)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view_factors::contour::contour;
    use raywright_base::sampling::Sampler;

    /// Two triangles with an edge, a corner or nothing in common, each wholly in front of the other.
    fn drawn(number: u32) -> Option<[Facet; 2]> {
        let mut sampler = Sampler::new(2, number, 0);
        let mut dimension = 0;
        let mut next = || {
            dimension += 1;
            sampler.one(dimension)
        };
        let mut corner = || DVec3::new(next() - 0.5, next() - 0.5, next() - 0.5);
        let (a, b, c, d, e, f) = (corner(), corner(), corner(), corner(), corner(), corner());
        let pair = match number % 3 {
            0 => [[a, b, c], [b, a, d]],
            1 => [[a, b, c], [a, d, e]],
            _ => [[a, b, c], [d, e, f]],
        };
        let [one, other] = pair.map(Facet::new);
        let heights = [one.heights(&other), other.heights(&one)];
        let is_before = heights.iter().all(|of| of.iter().all(|&h| h >= 0.0) && of.iter().any(|&h| h > 0.0));
        is_before.then_some([one, other])
    }

    #[test]
    fn it_agrees_with_integrals_around_both() {
        let mut asked = [0; 3];
        for number in 0..1500 {
            let Some([one, other]) = drawn(number) else { continue };
            let Some(found) = hinge(&one, &other, [one.heights(&other), other.heights(&one)]) else { continue };
            let around = contour(&one, &other);
            let radius = one.radius.max(other.radius);
            // The promised accuracy, plus rounding: terms of the contour integrals are of the order of the radii's
            // product, and some hundred of them add up.
            let enough = 1e-9 * found + 1e-13 * radius * radius;
            assert!((found - around).abs() < enough, "{number}: {found} {around}");
            asked[number as usize % 3] += 1;
        }
        assert!(asked.iter().all(|&asked| asked > 20), "{asked:?}");
    }

    #[test]
    fn faces_that_are_opposite_have_no_line_in_common() {
        // Slender and far apart: the small exchange is not due to coplanarity.
        let strip = |z: f64, turn: [usize; 3]| {
            let corners = [DVec3::new(0.0, 0.0, z), DVec3::new(1.0, 0.0, z), DVec3::new(0.0, 1e-3, z)];
            Facet::new(turn.map(|k| corners[k]))
        };
        let (one, other) = (strip(0.0, [0, 1, 2]), strip(1.0, [0, 2, 1]));
        assert_eq!(hinge(&one, &other, [one.heights(&other), other.heights(&one)]), None);
    }
}
