//! Two triangles that nothing lies between.

use super::contour::contour;
use super::distant::Quadrature;
use super::facet::{Facet, in_front};
use super::hinge::hinge;

/// How often a triangle is quartered to be no larger than another; what is left is then so near, and so small, that it
/// does not count.
const MOST_CUTS: u32 = 60;

/// Radii that differ by more are made alike by quartering the larger one: integrals around both would cancel.
const UNLIKE: f64 = 4.0;

/// Of the square of the radius, what is exchanged by so much more than roundings of integrals around both, which are
/// some 10⁻¹⁵ of it, that they are 10⁻⁹ at most.
const CANCELLED: f64 = 1e-6;

/// Heights that are a greater part of the radius are of triangles that exchange little because they are slender, and
/// not because they are in one plane.
const FLAT: f64 = 1.0 / 16.0;

/// Heights that are no greater a part of the radius are what roundings of corners leave of one plane. What is exchanged
/// is less than 10⁻²⁴ of the square of the radius, and to find it takes long.
const LEVEL: f64 = 1e-12;

/// The area of one triangle times its view factor to another, which is the other's times that to the one.
pub fn pair(quadrature: &mut Quadrature, one: &Facet, other: &Facet) -> f64 {
    let mut heights = [one.heights(other), other.heights(one)];
    if heights.iter().any(|of| of.iter().all(|&h| h <= 0.0)) {
        return 0.0;
    }
    // Where all heights are low, the least of them count.
    let flat = FLAT * one.radius.max(other.radius);
    if heights.as_flattened().iter().all(|h| h.abs() <= flat) && heights.as_flattened().contains(&0.0) {
        heights = [one.exact_heights(other), other.exact_heights(one)];
        let level = LEVEL * one.radius.max(other.radius);
        if heights.as_flattened().iter().all(|h| h.abs() <= level) {
            return 0.0;
        }
    }
    if heights.iter().flatten().all(|&h| h >= 0.0) {
        return before(quadrature, one, other, heights, MOST_CUTS);
    }
    let (parts, others) = (in_front(one, heights[1]), in_front(other, heights[0]));
    let mut sum = 0.0;
    for (part, to_other) in parts.iter().flatten() {
        for (other_part, to_one) in others.iter().flatten() {
            sum += before(quadrature, part, other_part, [*to_one, *to_other], MOST_CUTS);
        }
    }
    sum
}

/// The same of two that lie wholly in front of each other.
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
    let [above_larger, above_smaller] = if is_larger { heights } else { [heights[1], heights[0]] };
    let [a, b, c] = above_smaller;
    let [ab, bc, ca] = [0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)];
    let of_quarters = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [bc, ca, ab]];
    let quarters = larger.quarters();
    // `heights[0]` is of the second's corners above the first.
    let mut part = |i: usize| before(quadrature, &quarters[i], smaller, [above_larger, of_quarters[i]], cuts - 1);
    (0..4).map(&mut part).sum()
}
