//! What may lie between: the shaft of all segments from one thing to another (Haines and Wallace, "Shaft Culling for
//! Efficient Ray-Traced Radiosity", 1991), as planes that it lies behind.
//!
//! What only touches a shaft hides nothing, so all comparisons let rounding pass: of a plane's distance, 2⁻⁴⁸
//! of the
//! coordinates that it is computed from.

use super::clusters::Cluster;
use super::facet::Facet;
use raywright_base::math::DVec3;
use raywright_scene::Geometry;

const ROUNDING: f64 = 1.0 / (1u64 << 48) as f64;

/// What may hide one face from another.
#[derive(Clone, Copy, Debug)]
pub enum Blocker {
    /// A triangle.
    Facet(Facet),
    /// What is none, by its number.
    Curved(u32),
}

/// A half-space: `normal · x ≤ offset` within.
#[derive(Clone, Copy, Debug)]
pub struct HalfSpace {
    normal: DVec3,
    offset: f64,
    /// What rounding may make of a distance.
    rounding: f64,
}

impl Blocker {
    /// The greatest `d · x` of its points, or more.
    pub fn support(&self, geometry: &Geometry, d: DVec3) -> f64 {
        match self {
            Self::Facet(facet) => facet.corners.iter().fold(f64::NEG_INFINITY, |most, &c| most.max(d.dot(c))),
            Self::Curved(primitive) => geometry.shape(*primitive).map_or(f64::INFINITY, |shape| shape.support(d)),
        }
    }

    /// Whether none of it is within.
    #[inline]
    pub fn is_beyond(&self, geometry: &Geometry, half: &HalfSpace) -> bool {
        -self.support(geometry, -half.normal) >= half.offset - half.rounding
    }

    /// Whether its plane, if it is flat, has all of some points on one side.
    #[inline]
    pub fn has_aside(&self, points: impl IntoIterator<Item = DVec3>) -> bool {
        match self {
            Self::Facet(facet) => facet.sides(points) != [true, true],
            Self::Curved(_) => false,
        }
    }
}

/// The shaft between two boxes: the box around both, and planes along an axis over two edges.
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
            // Out of both boxes at this corner, if it is on the hull of their outlines.
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

/// The shaft between two triangles: planes through an edge of one and a corner of the other that have all on one side.
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
                // Without a branch for each: most planes are none of the shaft's.
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

/// Whether a triangle hides all of one from all of another: it parts them, and all segments between their corners go
/// through it, so that those between any of their points do. Each comes with the heights of its corners over the
/// blocker.
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
        // Inwards of each edge by more than rounding.
        let room = ROUNDING * (point.abs().max_element() + blocker.centre.abs().max_element() + blocker.radius);
        edges.iter().all(|(from, inwards)| inwards.dot(point - *from) > room * inwards.length())
    })
}
