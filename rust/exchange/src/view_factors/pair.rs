//! View factors of two triangles without blockers.

use super::contour::contour;
use super::distant::Quadrature;
use super::facet::{Facet, in_front};
use super::hinge::hinge;

/// Maximum depth of quartering the larger triangle; what remains is so near and so small that it is negligible.
const MOST_CUTS: u32 = 60;

/// Triangles with a larger ratio of radii are made similar by quartering the larger one, since contour integrals would
/// cancel.
const UNLIKE: f64 = 4.0;

/// Exchange relative to the squared radius, above which the rounding of contour integrals, some 10⁻¹⁵ of that square,
/// is at most 10⁻⁹.
const CANCELLED: f64 = 1e-6;

/// With heights above this fraction of the radius, a small exchange is due to slender triangles rather than to
/// coplanarity.
const FLAT: f64 = 1.0 / 16.0;

/// Heights up to this fraction of the radius are attributed to rounding of coplanar corners. The exchange is less than
/// 10⁻²⁴ of the squared radius, and computing it would take long.
const LEVEL: f64 = 1e-12;

/// Parts in front of the other triangle are dropped below this fraction of their triangle.
const DROPPED: f64 = 1e-11;

/// Parts of two triangles that are wholly in front of each other.
#[derive(Clone, Copy, Debug)]
pub struct Facing {
    /// A part of the first triangle, and one of the second.
    pub facets: [Facet; 2],
    /// The heights of the second's corners above the first, and vice versa.
    heights: [[f64; 3]; 2],
}

impl Facing {
    /// Their exchange without blockers.
    pub fn exchanged(&self, quadrature: &mut Quadrature) -> f64 {
        before(quadrature, &self.facets[0], &self.facets[1], self.heights, MOST_CUTS)
    }

    /// Return whether the distance of their centers is less than a multiple of the sum of their radii.
    pub fn is_within(&self, times: f64) -> bool {
        let [one, other] = &self.facets;
        one.centre.distance(other.centre) < times * (one.radius + other.radius)
    }

    /// Return whether both are nearly coplanar, which makes the exchange slow to compute.
    pub fn is_flat(&self) -> bool {
        let most = FLAT * self.facets[0].radius.max(self.facets[1].radius);
        self.heights.as_flattened().iter().all(|&height| height <= most)
    }

    /// The quarters of the larger one, each paired with the smaller one.
    pub fn quarters(&self) -> [Self; 4] {
        let [one, other] = &self.facets;
        let larger = usize::from(one.radius <= other.radius);
        let quarters = self.facets[larger].quarters();
        let [a, b, c] = self.heights[1 - larger];
        let [ab, bc, ca] = [0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)];
        let of_quarters = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [bc, ca, ab]];
        std::array::from_fn(|i| {
            let mut part = *self;
            part.facets[larger] = quarters[i];
            part.heights[1 - larger] = of_quarters[i];
            part
        })
    }
}

/// The parts of two triangles in front of each other, up to four pairs.
pub fn facing(one: &Facet, other: &Facet) -> impl Iterator<Item = Facing> {
    let mut heights = [one.heights(other), other.heights(one)];
    let mut is_any = heights.iter().all(|of| of.iter().any(|&h| h > 0.0));
    // If all heights are low, even the least of them matter.
    let flat = FLAT * one.radius.max(other.radius);
    if is_any && heights.as_flattened().iter().all(|h| h.abs() <= flat) && heights.as_flattened().contains(&0.0) {
        heights = [one.exact_heights(other), other.exact_heights(one)];
        let level = LEVEL * one.radius.max(other.radius);
        is_any = !heights.as_flattened().iter().all(|h| h.abs() <= level);
    }
    let (parts, others) = if !is_any {
        ([None; 2], [None; 2])
    } else if heights.as_flattened().iter().all(|&h| h >= 0.0) {
        ([Some((*one, heights[1])), None], [Some((*other, heights[0])), None])
    } else {
        // Dropped parts emit at most this fraction of the whole, and might take millions of quarters of the other
        // triangle.
        let counts = |whole: &Facet, part: &Facet| part.area >= DROPPED * whole.area;
        let of_one = in_front(one, heights[1]).map(|part| part.filter(|(part, _)| counts(one, part)));
        (of_one, in_front(other, heights[0]).map(|part| part.filter(|(part, _)| counts(other, part))))
    };
    let both = parts.into_iter().flatten().flat_map(move |part| others.into_iter().flatten().map(move |o| (part, o)));
    both.map(|((part, to_other), (other, to_one))| Facing { facets: [part, other], heights: [to_one, to_other] })
}

/// The area of one triangle times its view factor to another, which is symmetric.
pub fn pair(quadrature: &mut Quadrature, one: &Facet, other: &Facet) -> f64 {
    facing(one, other).fold(0.0, |sum, part| sum + part.exchanged(quadrature))
}

/// The same for triangles wholly in front of each other.
fn before(quadrature: &mut Quadrature, one: &Facet, other: &Facet, heights: [[f64; 3]; 2], cuts: u32) -> f64 {
    if let Some(found) = quadrature.distant(one, other, heights) {
        return found;
    }
    let is_larger = one.radius > other.radius;
    let (larger, smaller) = if is_larger { (one, other) } else { (other, one) };
    if larger.radius <= UNLIKE * smaller.radius || cuts == 0 {
        let found = contour(one, other);
        let is_flat = heights.as_flattened().iter().all(|&height| height <= FLAT * larger.radius);
        if !is_flat || found > CANCELLED * larger.radius * larger.radius {
            return found.max(0.0);
        }
        return hinge(one, other, heights).unwrap_or(found.max(0.0));
    }
    let ordered = if is_larger { heights } else { [heights[1], heights[0]] };
    let facing = Facing { facets: [*larger, *smaller], heights: ordered };
    let mut part = |part: Facing| before(quadrature, &part.facets[0], &part.facets[1], part.heights, cuts - 1);
    facing.quarters().into_iter().map(&mut part).sum()
}
