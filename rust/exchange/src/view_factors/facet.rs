//! One-sided triangles, and the part of a triangle in front of a plane.

use raywright_base::math::{DVec3, DoubleDouble};

/// A triangle that emits from the side of its normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    /// Its corners, anticlockwise as seen from the front.
    pub corners: [DVec3; 3],
    /// The unit normal; zero for a degenerate triangle.
    pub normal: DVec3,
    /// Its area.
    pub area: f64,
    /// The mean of its corners.
    pub centre: DVec3,
    /// The distance of the farthest corner from the center.
    pub radius: f64,
    /// The rounding error of its coordinates.
    noise: f64,
}

/// Rounding error of a height relative to the distance and the coordinates: 16 of 2⁻⁵³ each.
const ROUNDING: f64 = 1.0 / (1u64 << 49) as f64;

/// Heights below this fraction of the distance have a relative error above 10⁻¹⁰, and are recomputed.
const FLAT: f64 = 1.0 / (1u64 << 18) as f64;

/// Heights above this multiple of the coordinates' rounding errors are not affected by them.
const STEEP: f64 = (1u64 << 31) as f64;

/// Points outside a triangle by at most this fraction of its radius count as inside.
const NEXT: f64 = 1e-9;

impl Facet {
    /// The triangle with the given corners.
    pub fn new(corners: [DVec3; 3]) -> Self {
        let [a, b, c] = corners;
        let centre = a + ((b - a) + (c - a)) / 3.0;
        let radius = corners.iter().fold(0.0f64, |most, corner| most.max(corner.distance(centre)));
        let coordinate = corners.iter().fold(0.0f64, |most, corner| most.max(corner.abs().max_element()));
        // In units of the radius, to avoid underflow of squares.
        let unit = if radius > 0.0 { 1.0 / radius } else { 0.0 };
        let vector = ((b - a) * unit).cross((c - a) * unit);
        let length = vector.length();
        let normal = if length > 0.0 { vector / length } else { DVec3::ZERO };
        Self { corners, normal, area: 0.5 * length * radius * radius, centre, radius, noise: ROUNDING * coordinate }
    }

    /// The signed height of a point above the plane; 0 if within rounding.
    #[inline]
    pub fn height(&self, point: DVec3) -> f64 {
        let from = point - self.centre;
        let height = self.normal.dot(from);
        // The height of a point well off the plane is accurate.
        if height.abs() > FLAT * (from.abs().element_sum() + self.radius) + STEEP * self.noise {
            return height;
        }
        self.low_height(point)
    }

    /// The same for a point near the plane.
    #[inline(never)]
    fn low_height(&self, point: DVec3) -> f64 {
        let [a, b, c] = self.corners.map(|corner| point - corner);
        let [aa, bb, cc] = [a, b, c].map(DVec3::length_squared);
        // From the nearest corner, so that it is exactly 0 for a shared corner.
        let from = if aa <= bb && aa <= cc {
            a
        } else if bb <= cc {
            b
        } else {
            c
        };
        let height = self.normal.dot(from);
        let far = from.length() + self.radius;
        if height.abs() > FLAT * far {
            height
        } else if height.abs() <= ROUNDING * far + self.noise {
            0.0
        } else {
            self.flat_height(point)
        }
    }

    /// The accurate height of a point very near the plane: a double-double volume over an area.
    #[cold]
    fn flat_height(&self, point: DVec3) -> f64 {
        let [a, b, c] = self.corners;
        // A power of two, to avoid underflow of products.
        let unit = 2f64.powi(-(self.radius.log2().round() as i32));
        let from = |p: DVec3| [0, 1, 2].map(|k| DoubleDouble::difference(p[k], a[k]).scaled(unit));
        let ([ax, ay, az], [bx, by, bz], [px, py, pz]) = (from(b), from(c), from(point));
        let volume = px * (ay * bz - az * by) + py * (az * bx - ax * bz) + pz * (ax * by - ay * bx);
        volume.to_f64() / (2.0 * self.area * unit * unit * unit)
    }

    /// Accurate heights where apparent rounding may be a real gap: 0 for shared corners only.
    #[cold]
    pub fn exact_heights(&self, other: &Self) -> [f64; 3] {
        other.corners.map(|corner| if self.corners.contains(&corner) { 0.0 } else { self.flat_height(corner) })
    }

    /// Return whether some points are in front of the plane, and whether some are behind.
    #[inline]
    pub fn sides(&self, points: impl IntoIterator<Item = DVec3>) -> [bool; 2] {
        let mut found = [false; 2];
        for point in points {
            let from = point - self.centre;
            let height = self.normal.dot(from);
            // The L1 norm is an upper bound of the distance, without a root.
            let rounding = ROUNDING * (from.abs().element_sum() + self.radius) + self.noise;
            found[0] |= height > rounding;
            found[1] |= height < -rounding;
        }
        found
    }

    /// The heights of another triangle's corners.
    #[inline]
    pub fn heights(&self, other: &Self) -> [f64; 3] {
        let [a, b, c] = other.corners;
        [self.height(a), self.height(b), self.height(c)]
    }

    /// Return whether a point of the plane is inside or adjacent.
    pub fn covers(&self, point: DVec3) -> bool {
        self.covers_by(point, -NEXT)
    }

    /// Return whether a point of the plane is inside by at least `margin` radii.
    pub fn covers_by(&self, point: DVec3, margin: f64) -> bool {
        (0..3).all(|i| {
            let (from, edge) = (self.corners[i], self.corners[(i + 1) % 3] - self.corners[i]);
            self.normal.cross(edge).dot(point - from) >= margin * self.radius * edge.length()
        })
    }

    /// The barycentric weights of the second and third corner for a point of the plane.
    pub fn weights(&self, point: DVec3) -> [f64; 2] {
        let [a, b, c] = self.corners;
        let share = |one: DVec3, other: DVec3| self.normal.dot(one.cross(other)) / (2.0 * self.area);
        let (second, third) = (share(point - a, c - a).max(0.0), share(b - a, point - a).max(0.0));
        let whole = (second + third).max(1.0);
        [second / whole, third / whole]
    }

    /// The four congruent quarters.
    pub fn quarters(&self) -> [Self; 4] {
        let [a, b, c] = self.corners;
        let (p, q, r) = (0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a));
        // They have the same plane, despite the rounding of the midpoints.
        [[a, p, r], [p, b, q], [r, q, c], [q, r, p]].map(|corners| Self {
            corners,
            area: 0.25 * self.area,
            centre: corners[0] + ((corners[1] - corners[0]) + (corners[2] - corners[0])) / 3.0,
            radius: 0.5 * self.radius,
            ..*self
        })
    }
}

/// The part of a triangle in front of a plane, as up to two triangles with their heights above it.
pub fn in_front(facet: &Facet, heights: [f64; 3]) -> [Option<(Facet, [f64; 3])>; 2] {
    if heights.iter().all(|&h| h <= 0.0) {
        return [None, None];
    }
    if heights.iter().all(|&h| h >= 0.0) {
        return [Some((*facet, heights)), None];
    }
    let mut kept = [(DVec3::ZERO, 0.0); 4];
    let mut count = 0;
    for i in 0..3 {
        let j = (i + 1) % 3;
        let (from, to) = (heights[i], heights[j]);
        if from >= 0.0 {
            kept[count] = (facet.corners[i], from);
            count += 1;
        }
        if (from > 0.0 && to < 0.0) || (from < 0.0 && to > 0.0) {
            // Interpolated from the end in front, so that both triangles at an edge have the same point.
            let (near, far, a, b) = if from > 0.0 {
                (facet.corners[i], facet.corners[j], from, to)
            } else {
                (facet.corners[j], facet.corners[i], to, from)
            };
            kept[count] = (near + (far - near) * (a / (a - b)), 0.0);
            count += 1;
        }
    }
    let part = |corners: [(DVec3, f64); 3]| {
        let part = Facet::new(corners.map(|corner| corner.0));
        let part = Facet { normal: facet.normal, noise: facet.noise, ..part };
        (part.area > 0.0).then_some((part, corners.map(|corner| corner.1)))
    };
    match count {
        3 => [part([kept[0], kept[1], kept[2]]), None],
        4 => [part([kept[0], kept[1], kept[2]]), part([kept[0], kept[2], kept[3]])],
        _ => [None, None],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_in_front_and_behind_make_the_whole() {
        let facet = Facet::new([DVec3::ZERO, DVec3::new(2.0, 0.0, 0.5), DVec3::new(0.3, 1.5, -0.25)]);
        for plane in [[1.0, -1.0, 2.0], [-1.0, 2.0, 0.25], [0.0, 1.0, -3.0], [1.0, 2.0, 3.0], [-1.0, -1.0, -1e-9]] {
            let area = |heights| in_front(&facet, heights).iter().flatten().map(|part| part.0.area).sum::<f64>();
            let both = area(plane) + area(plane.map(|h| -h));
            assert!((both - facet.area).abs() < 1e-15 * 8.0, "{plane:?} {both}");
        }
    }

    #[test]
    fn heights_vanish_on_shared_corners_and_planes() {
        let corners = [[0.1, 0.2, 0.3], [1.7, 0.4, 0.9], [0.6, 1.9, 0.2]].map(DVec3::from);
        let facet = Facet::new(corners);
        assert_eq!(facet.heights(&facet), [0.0; 3]);
        let beyond = corners[0] + (corners[1] - corners[0]) * 7.3 - (corners[2] - corners[0]) * 2.1;
        assert_eq!(facet.height(beyond), 0.0);
        assert!(facet.height(beyond + 1e-12 * facet.normal) > 0.0);
        let small = Facet::new(corners.map(|c| c * 1e-160));
        assert!((small.normal - facet.normal).length() < 1e-15 && small.area > 0.0);
        assert_eq!(Facet::new([corners[0]; 3]).area, 0.0);
        for part in facet.quarters() {
            assert_eq!((part.normal, part.area), (facet.normal, 0.25 * facet.area));
        }
    }
}
