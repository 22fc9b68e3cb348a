//! Triangles that send and receive, and what of them lies in front of another's plane.

use raywright_base::math::{DVec3, DoubleDouble};

/// A triangle that sends from the side of its normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    /// Its corners, anticlockwise as seen from the front.
    pub corners: [DVec3; 3],
    /// The unit normal; zero where it has no area.
    pub normal: DVec3,
    /// Its area.
    pub area: f64,
    /// Where the middle of its corners is.
    pub centre: DVec3,
    /// How far from there the farthest corner is.
    pub radius: f64,
    /// What the roundings of its coordinates may be.
    noise: f64,
}

/// Roundings of a height, as a part of the distance and of the coordinates: 16 of 2⁻⁵³ each.
const ROUNDING: f64 = 1.0 / (1u64 << 49) as f64;

/// Heights that are a smaller part of the distance have lost more than 10⁻¹⁰ of themselves, and are computed anew.
const FLAT: f64 = 1.0 / (1u64 << 18) as f64;

/// What makes as much of the roundings of coordinates: of a height that is more, they are no part that counts.
const STEEP: f64 = (1u64 << 31) as f64;

/// What is no farther outside of a triangle, as a part of its radius, counts as within.
const NEXT: f64 = 1e-9;

impl Facet {
    /// Of these corners.
    pub fn new(corners: [DVec3; 3]) -> Self {
        let [a, b, c] = corners;
        let centre = a + ((b - a) + (c - a)) / 3.0;
        let radius = corners.iter().fold(0.0f64, |most, corner| most.max(corner.distance(centre)));
        let coordinate = corners.iter().fold(0.0f64, |most, corner| most.max(corner.abs().max_element()));
        // In units of its own, so that no square vanishes however small it is.
        let unit = if radius > 0.0 { 1.0 / radius } else { 0.0 };
        let vector = ((b - a) * unit).cross((c - a) * unit);
        let length = vector.length();
        let normal = if length > 0.0 { vector / length } else { DVec3::ZERO };
        Self { corners, normal, area: 0.5 * length * radius * radius, centre, radius, noise: ROUNDING * coordinate }
    }

    /// How far a point is in front of the plane: 0 where that is no more than rounding.
    #[inline]
    pub fn height(&self, point: DVec3) -> f64 {
        let from = point - self.centre;
        let height = self.normal.dot(from);
        // Of a point well off the plane, all digits that count are right.
        if height.abs() > FLAT * (from.abs().element_sum() + self.radius) + STEEP * self.noise {
            return height;
        }
        self.low_height(point)
    }

    /// The same of a point that is not far from the plane.
    #[inline(never)]
    fn low_height(&self, point: DVec3) -> f64 {
        let [a, b, c] = self.corners.map(|corner| point - corner);
        let [aa, bb, cc] = [a, b, c].map(DVec3::length_squared);
        // From the nearest corner: exactly 0 of a corner that two have in common.
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

    /// The height of a point next to the plane, to all digits: a volume by numbers of twice the length, over an area.
    #[cold]
    fn flat_height(&self, point: DVec3) -> f64 {
        let [a, b, c] = self.corners;
        // A power of two, so that no product vanishes.
        let unit = 2f64.powi(-(self.radius.log2().round() as i32));
        let from = |p: DVec3| [0, 1, 2].map(|k| DoubleDouble::difference(p[k], a[k]).scaled(unit));
        let ([ax, ay, az], [bx, by, bz], [px, py, pz]) = (from(b), from(c), from(point));
        let volume = px * (ay * bz - az * by) + py * (az * bx - ax * bz) + pz * (ax * by - ay * bx);
        volume.to_f64() / (2.0 * self.area * unit * unit * unit)
    }

    /// The same with all digits, where what is taken for rounding may be a gap: 0 of corners in common alone.
    #[cold]
    pub fn exact_heights(&self, other: &Self) -> [f64; 3] {
        other.corners.map(|corner| if self.corners.contains(&corner) { 0.0 } else { self.flat_height(corner) })
    }

    /// On which side of the plane points are at most: whether some are in front, and whether some are behind.
    #[inline]
    pub fn sides(&self, points: impl IntoIterator<Item = DVec3>) -> [bool; 2] {
        let mut found = [false; 2];
        for point in points {
            let from = point - self.centre;
            let height = self.normal.dot(from);
            // The sum of coordinates is no less than the distance, and takes no root.
            let rounding = ROUNDING * (from.abs().element_sum() + self.radius) + self.noise;
            found[0] |= height > rounding;
            found[1] |= height < -rounding;
        }
        found
    }

    /// The heights of another's corners.
    #[inline]
    pub fn heights(&self, other: &Self) -> [f64; 3] {
        let [a, b, c] = other.corners;
        [self.height(a), self.height(b), self.height(c)]
    }

    /// Whether a point of the plane is within, or next to it.
    pub fn covers(&self, point: DVec3) -> bool {
        self.covers_by(point, -NEXT)
    }

    /// Whether a point of the plane is within, and by so many radii away from its border.
    pub fn covers_by(&self, point: DVec3, margin: f64) -> bool {
        (0..3).all(|i| {
            let (from, edge) = (self.corners[i], self.corners[(i + 1) % 3] - self.corners[i]);
            self.normal.cross(edge).dot(point - from) >= margin * self.radius * edge.length()
        })
    }

    /// The weights of the second and third corner of a point of the plane.
    pub fn weights(&self, point: DVec3) -> [f64; 2] {
        let [a, b, c] = self.corners;
        let share = |one: DVec3, other: DVec3| self.normal.dot(one.cross(other)) / (2.0 * self.area);
        let (second, third) = (share(point - a, c - a).max(0.0), share(b - a, point - a).max(0.0));
        let whole = (second + third).max(1.0);
        [second / whole, third / whole]
    }

    /// The four parts that halved edges make, all alike.
    pub fn quarters(&self) -> [Self; 4] {
        let [a, b, c] = self.corners;
        let (p, q, r) = (0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a));
        // Their planes are its own, whatever the halves are rounded to.
        [[a, p, r], [p, b, q], [r, q, c], [q, r, p]].map(|corners| Self {
            corners,
            area: 0.25 * self.area,
            centre: corners[0] + ((corners[1] - corners[0]) + (corners[2] - corners[0])) / 3.0,
            radius: 0.5 * self.radius,
            ..*self
        })
    }
}

/// What of a triangle lies in front of a plane, and its heights above that: one triangle or two, of its own plane; none
/// if there is nothing.
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
            // From the end in front, so that both triangles at an edge have the same point.
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
