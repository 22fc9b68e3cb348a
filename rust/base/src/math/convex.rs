//! Convex polygons in 2D, and their intersections with lines and each other.
//!
//! A cut computes each intersection with the line once, for both parts. So the parts' areas add up to the whole to
//! within rounding, and the parts of neighbors meet without a gap.

use super::DVec3;
use glam::DVec2;

/// The corners of a convex polygon, in order, in either orientation.
pub type Convex = Vec<DVec2>;

/// The half-plane `line.x · x + line.y · y + line.z > 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfPlane {
    /// The three coefficients.
    pub line: DVec3,
    /// Corners with an absolute value of at most this are on the line.
    pub slack: f64,
}

impl HalfPlane {
    /// The half-plane beside the line from `a` to `b` that contains `within`; `None` if all three are collinear.
    pub fn through(a: DVec2, b: DVec2, within: DVec2, slack: f64) -> Option<Self> {
        let normal = (b - a).perp();
        let side = normal.dot(within - a);
        let length = normal.length();
        (side.abs() > slack * length).then(|| {
            let normal = normal * (side.signum() / length);
            Self { line: normal.extend(-normal.dot(a)), slack }
        })
    }

    /// The signed value, positive inside, and 0 within the slack.
    #[inline]
    pub fn value(&self, at: DVec2) -> f64 {
        let value = self.line.x * at.x + self.line.y * at.y + self.line.z;
        if value.abs() <= self.slack { 0.0 } else { value }
    }
}

/// The half-planes whose intersection is a convex polygon; sides lie on their lines to within `slack`.
pub fn sides(polygon: &[DVec2], slack: f64) -> Vec<HalfPlane> {
    let middle = polygon.iter().sum::<DVec2>() / polygon.len() as f64;
    let side = |i: usize| HalfPlane::through(polygon[i], polygon[(i + 1) % polygon.len()], middle, slack);
    (0..polygon.len()).filter_map(side).collect()
}

/// A triangle fan: twice the signed area of each triangle, and three times its centroid relative to the first corner.
fn fans(polygon: &[DVec2]) -> impl Iterator<Item = (f64, DVec2)> {
    polygon.windows(2).skip(1).map(|pair| {
        let (a, b) = (pair[0] - polygon[0], pair[1] - polygon[0]);
        (a.perp_dot(b), a + b)
    })
}

/// The area of a convex polygon in either orientation.
pub fn area(polygon: &[DVec2]) -> f64 {
    0.5 * fans(polygon).map(|(twice, _)| twice).sum::<f64>().abs()
}

/// The centroid of a convex polygon; of a degenerate one, that of its corners.
pub fn centroid(polygon: &[DVec2]) -> DVec2 {
    let (area, moment) =
        fans(polygon).fold((0.0, DVec2::ZERO), |(area, moment), (twice, at)| (area + twice, moment + at * twice));
    let middle = polygon[0] + moment / (3.0 * area);
    if middle.is_finite() { middle } else { polygon.iter().sum::<DVec2>() / polygon.len() as f64 }
}

/// Split a convex polygon into the parts inside and outside. Either may be empty.
pub fn cut(polygon: &[DVec2], by: &HalfPlane) -> [Convex; 2] {
    let mut parts = [Convex::new(), Convex::new()];
    let mut before = polygon[polygon.len() - 1];
    let mut value_before = by.value(before);
    for &corner in polygon {
        let value = by.value(corner);
        if value * value_before < 0.0 {
            let crossing = before + (corner - before) * (value_before / (value_before - value));
            parts.iter_mut().for_each(|part| part.push(crossing));
        }
        if value >= 0.0 {
            parts[0].push(corner);
        }
        if value <= 0.0 {
            parts[1].push(corner);
        }
        (before, value_before) = (corner, value);
    }
    parts.map(|part| if part.len() < 3 { Convex::new() } else { part })
}

/// Clip a convex polygon to an intersection of half-planes; the result may be empty.
pub fn clip(polygon: &[DVec2], region: &[HalfPlane]) -> Convex {
    let mut left = polygon.to_vec();
    for side in region {
        if left.is_empty() {
            break;
        }
        [left, _] = cut(&left, side);
    }
    left
}

/// Split a convex polygon by an intersection of half-planes. Convex pieces of the outside are appended to `outside`,
/// and the inside is returned. If that is empty, the polygon is appended whole.
pub fn take_out(polygon: Convex, region: &[HalfPlane], outside: &mut Vec<Convex>) -> Convex {
    let is_beyond = |side: &HalfPlane| polygon.iter().all(|&corner| side.value(corner) <= 0.0);
    if region.iter().any(is_beyond) || clip(&polygon, region).is_empty() {
        outside.push(polygon);
        return Convex::new();
    }
    let mut left = polygon;
    for side in region {
        let [within, beyond] = cut(&left, side);
        if area(&beyond) > 0.0 {
            outside.push(beyond);
        }
        left = within;
    }
    left
}

/// Clip a polygon in space to where a linear function is positive; corners within the slack are on the border.
pub fn above(polygon: &[DVec3], value: impl Fn(DVec3) -> f64, slack: f64) -> Vec<DVec3> {
    let value = |at: DVec3| Some(value(at)).filter(|v| v.abs() > slack).unwrap_or(0.0);
    if polygon.iter().all(|&corner| value(corner) <= 0.0) {
        return Vec::new();
    }
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, &corner) in polygon.iter().enumerate() {
        let before = polygon[(i + polygon.len() - 1) % polygon.len()];
        let (here, there) = (value(corner), value(before));
        if here * there < 0.0 {
            kept.push(before + (corner - before) * (there / (there - here)));
        }
        if here >= 0.0 {
            kept.push(corner);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SLACK: f64 = 1e-12;

    /// Corners on a circle, in order.
    fn polygon() -> impl Strategy<Value = Convex> {
        (-3.0..3.0f64, -3.0..3.0f64, 0.3..4.0f64, prop::collection::vec(0.3..1.5f64, 3..9)).prop_map(
            |(x, y, r, gaps)| {
                let all: f64 = gaps.iter().sum();
                let mut angle = 0.0;
                let corner = |gap: &f64| {
                    angle += gap / all * std::f64::consts::TAU;
                    DVec2::new(x, y) + DVec2::from_angle(angle) * r
                };
                gaps.iter().map(corner).collect()
            },
        )
    }

    proptest! {
        #[test]
        fn what_is_taken_out_and_what_is_left_are_the_whole(whole in polygon(), other in polygon()) {
            let mut outside = Vec::new();
            let inside = take_out(whole.clone(), &sides(&other, SLACK), &mut outside);
            let left: f64 = outside.iter().map(|piece| area(piece)).sum();
            prop_assert!((area(&inside) + left - area(&whole)).abs() < 1e-12 * (1.0 + area(&whole)));
            // The intersection is symmetric.
            let shared = take_out(other.clone(), &sides(&whole, SLACK), &mut Vec::new());
            prop_assert!((area(&shared) - area(&inside)).abs() < 1e-10);
            // The centroid of the whole is that of its pieces.
            let all = outside.iter().chain([&inside]).filter(|piece| !piece.is_empty());
            let moment: DVec2 = all.map(|piece| centroid(piece) * area(piece)).sum();
            prop_assert!((moment / area(&whole) - centroid(&whole)).length() < 1e-10);
        }

        #[test]
        fn a_square_that_is_clipped_has_the_area_under_its_edge(slope in -1.0..1.0f64, height in 1.0..2.0f64) {
            // Below y = height + slope (x - 1/2), inside a square from 0 to 3: a trapezoid of unit width.
            let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 3.0], [0.0, 3.0]].map(DVec2::from_array);
            let below = HalfPlane { line: DVec3::new(slope, -1.0, height - 0.5 * slope), slack: 0.0 };
            prop_assert!((area(&clip(&square, &[below])) - height).abs() < 1e-14);
        }
    }

    #[test]
    fn neighbours_take_nothing_from_each_other() {
        let square = |x: f64| [[x, 0.0], [x + 0.1, 0.0], [x + 0.1, 1.0], [x, 1.0]].map(DVec2::from_array).to_vec();
        let mut outside = Vec::new();
        assert!(take_out(square(0.2), &sides(&square(0.3), SLACK), &mut outside).is_empty());
        assert_eq!(outside, [square(0.2)]);
        // A polygon minus itself is empty.
        outside.clear();
        assert_eq!(take_out(square(0.2), &sides(&square(0.2), SLACK), &mut outside), square(0.2));
        assert!(outside.is_empty());
    }
}
