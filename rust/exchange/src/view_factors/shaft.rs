//! Potential blockers: the shaft of all segments between two objects (Haines and Wallace, "Shaft Culling for Efficient
//! Ray-Traced Radiosity", 1991), as an intersection of half-spaces.
//!
//! An object that only touches a shaft hides nothing, so all comparisons allow for rounding: for distances from a
//! plane, 2⁻⁴⁸ of the coordinates involved.

use super::clusters::Cluster;
use super::facet::Facet;
use raywright_base::math::DVec3;
use raywright_scene::Geometry;

const ROUNDING: f64 = 1.0 / (1u64 << 48) as f64;

/// An object that may hide one face from another.
#[derive(Clone, Copy, Debug)]
pub enum Blocker {
    /// A triangle.
    Facet(Facet),
    /// Another shape, by number.
    Curved(u32),
}

/// The half-space `normal · x ≤ offset`.
#[derive(Clone, Copy, Debug)]
pub struct HalfSpace {
    normal: DVec3,
    offset: f64,
    /// The rounding error of a distance.
    rounding: f64,
}

impl Blocker {
    /// An upper bound of the support function: the greatest `d · x` over its points.
    pub fn support(&self, geometry: &Geometry, d: DVec3) -> f64 {
        match self {
            Self::Facet(facet) => facet.corners.iter().fold(f64::NEG_INFINITY, |most, &c| most.max(d.dot(c))),
            Self::Curved(primitive) => geometry.shape(*primitive).map_or(f64::INFINITY, |shape| shape.support(d)),
        }
    }

    /// Return whether it is wholly outside a half-space.
    #[inline]
    pub fn is_beyond(&self, geometry: &Geometry, half: &HalfSpace) -> bool {
        -self.support(geometry, -half.normal) >= half.offset - half.rounding
    }

    /// Return whether it is flat and its plane has all the points on one side.
    #[inline]
    pub fn has_aside(&self, points: impl IntoIterator<Item = DVec3>) -> bool {
        match self {
            Self::Facet(facet) => facet.sides(points) != [true, true],
            Self::Curved(_) => false,
        }
    }
}

/// The shaft between two boxes: their bounding box, and axis-parallel planes through one edge of each.
pub fn between_boxes(one: &Cluster, other: &Cluster) -> Vec<HalfSpace> {
    let (low, high) = (one.low.min(other.low), one.high.max(other.high));
    let rounding = ROUNDING * low.abs().max(high.abs()).max_element();
    let mut found = Vec::with_capacity(18);
    for k in 0..3 {
        let axis = DVec3::AXES[k];
        found.push(HalfSpace { normal: axis, offset: high[k], rounding });
        found.push(HalfSpace { normal: -axis, offset: -low[k], rounding });
    }
    for axis in 0..3 {
        let (k, l) = ((axis + 1) % 3, (axis + 2) % 3);
        for corner in 0..4 {
            let pick = |of: &Cluster| {
                let x = if corner & 1 == 0 { of.low[k] } else { of.high[k] };
                let y = if corner & 2 == 0 { of.low[l] } else { of.high[l] };
                (x, y)
            };
            let (from, to) = (pick(one), pick(other));
            let way = (to.0 - from.0, to.1 - from.1);
            let length = way.0.hypot(way.1);
            if length <= rounding {
                continue;
            }
            // Outward from both boxes at this corner, if it is on the convex hull of their outlines.
            let mut normal = DVec3::ZERO;
            (normal[k], normal[l]) = (way.1 / length, -way.0 / length);
            let out = if corner & 1 == 0 { -normal[k] } else { normal[k] };
            let up = if corner & 2 == 0 { -normal[l] } else { normal[l] };
            if out * up < 0.0 {
                continue;
            }
            if out + up < 0.0 {
                normal = -normal;
            }
            found.push(HalfSpace { normal, offset: normal[k] * from.0 + normal[l] * from.1, rounding: 2.0 * rounding });
        }
    }
    found
}

/// The shaft between two triangles: planes through an edge of one and a corner of the other with all corners on one
/// side.
pub fn between_facets(one: &Facet, other: &Facet) -> Vec<HalfSpace> {
    let all = [one.corners, other.corners];
    let most = all.iter().flatten().fold(0.0f64, |most, corner| most.max(corner.abs().max_element()));
    let rounding = ROUNDING * most;
    let mut found = Vec::with_capacity(18);
    for (edges, corners) in [(all[0], all[1]), (all[1], all[0])] {
        for i in 0..3 {
            let (from, to) = (edges[i], edges[(i + 1) % 3]);
            for corner in corners {
                let normal = (to - from).cross(corner - from).normalize_or_zero();
                if normal == DVec3::ZERO {
                    continue;
                }
                let offset = normal.dot(from);
                // Branchless, since most planes do not bound the shaft.
                let heights = all.as_flattened().iter().map(|&point| normal.dot(point) - offset);
                let (low, high) = heights.fold((0.0f64, 0.0f64), |(low, high), h| (low.min(h), high.max(h)));
                if high <= rounding {
                    found.push(HalfSpace { normal, offset, rounding });
                } else if low >= -rounding {
                    found.push(HalfSpace { normal: -normal, offset: -offset, rounding });
                }
            }
        }
    }
    found
}

/// Return whether a triangle hides all of one triangle from all of another. It separates them, and all segments between
/// their corners pass through it, so those between any of their points do. Each comes with its corners' heights above
/// the blocker.
pub fn hides(blocker: &Facet, (one, from): (&Facet, [f64; 3]), (other, to): (&Facet, [f64; 3])) -> bool {
    let parts = |of: [f64; 3], than: [f64; 3]| of.iter().all(|&h| h > 0.0) && than.iter().all(|&h| h < 0.0);
    if !parts(from, to) && !parts(to, from) {
        return false;
    }
    let [a, b, c] = blocker.corners;
    let edges = [(a, b), (b, c), (c, a)].map(|(from, to)| (from, blocker.normal.cross(to - from)));
    (0..9).all(|i| {
        let (i, j) = (i / 3, i % 3);
        let share = from[i] / (from[i] - to[j]);
        let point = one.corners[i] + (other.corners[j] - one.corners[i]) * share;
        // Inside each edge by more than rounding.
        let room = ROUNDING * (point.abs().max_element() + blocker.centre.abs().max_element() + blocker.radius);
        edges.iter().all(|(from, inwards)| inwards.dot(point - *from) > room * inwards.length())
    })
}
