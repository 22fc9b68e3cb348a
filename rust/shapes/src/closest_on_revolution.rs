//! Closest points of surfaces of revolution under a non-uniformly scaling map.
//!
//! In each half-plane through the axis the closest point of the profile curve has a (nearly) closed form. As a function
//! of the angle, the distance changes no faster than points of the curve move, which bounds it over an interval of
//! angles (Piyavskii 1972; Shubert, "A Sequential Method Seeking the Global Maximum of a Function", 1972). Intervals
//! that cannot hold the minimum are discarded and the others bisected until each holds one local minimum. There the
//! offset is at right angles to the motion under rotation.

use super::closest_points::of_ellipsoid;
use raywright_base::math::{Affine, DVec3, Frame};
use std::f64::consts::TAU;

/// Initial number of intervals, number of bisections, and maximum number of intervals. If all angles are equally close,
/// any of them will do.
const FIRST: usize = 32;
const HALVINGS: usize = 9;
const MOST: usize = 512;

/// Maximum number of local minima to refine.
const VALLEYS: usize = 8;

/// The images of an axis and its normal directions, relative to the query point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around {
    /// The image of the origin of radii and heights.
    pub foot: DVec3,
    /// The images of unit vectors across the axis.
    across: [DVec3; 2],
    /// The image of the unit vector along the axis.
    pub up: DVec3,
}

/// The closest point of a profile curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct CurvePoint {
    /// The offset from the query point.
    pub way: DVec3,
    /// Distance from the axis and height along it, before mapping.
    pub radius: f64,
    pub height: f64,
}

/// The closest point over all angles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    /// The offset from the foot in the frame of the axis, before mapping.
    pub local: DVec3,
    pub distance: f64,
}

#[derive(Clone, Copy)]
struct Sample {
    angle: f64,
    distance: f64,
    /// Has the sign of the distance's derivative.
    slope: f64,
    met: CurvePoint,
}

impl Around {
    /// Set up the axis of a frame through a point.
    pub fn new(map: &Affine, frame: &Frame, foot: DVec3, place: DVec3) -> Self {
        let across = [map.vector(frame.tangent), map.vector(frame.bitangent)];
        Self { foot: map.point(foot) - place, across, up: map.vector(frame.normal) }
    }

    /// Minimize over all angles. At each angle `curve` returns the closest point of the profile in that half-plane,
    /// given the image of the unit vector away from the axis. The profile stays within `widest` of the axis.
    pub fn nearest(&self, widest: f64, curve: impl Fn(DVec3) -> CurvePoint) -> Nearest {
        let [x, y] = self.across;
        let at = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            let met = curve(x * cos + y * sin);
            let slope = met.way.dot(y * cos - x * sin);
            Sample { angle, distance: met.way.length(), slope: slope * met.radius, met }
        };
        let speed = widest * x.length().hypot(y.length());
        let mut width = TAU / FIRST as f64;
        let mut kept: Vec<Sample> = (0..FIRST).map(|i| at((i as f64 + 0.5) * width)).collect();
        let mut best = kept[0];
        for halving in 0..=HALVINGS {
            best = kept.iter().fold(best, |best, &sample| nearer(best, sample));
            let limit = best.distance * (1.0 + 4.0 * f64::EPSILON) + speed * width / 2.0;
            kept.retain(|sample| sample.distance <= limit);
            if halving == HALVINGS || kept.len() > MOST {
                break;
            }
            width /= 2.0;
            kept = kept.iter().flat_map(|s| [s.angle - width / 2.0, s.angle + width / 2.0]).map(at).collect();
        }
        let mut valleys: Vec<Sample> = (0..kept.len())
            .filter(|&i| {
                let beside = [kept[(i + kept.len() - 1) % kept.len()], kept[(i + 1) % kept.len()]];
                let is_near = |other: &Sample| {
                    let away = (other.angle - kept[i].angle).rem_euclid(TAU);
                    away.min(TAU - away) < 1.5 * width
                };
                beside.iter().filter(|other| is_near(other)).all(|other| kept[i].distance <= other.distance)
            })
            .map(|i| kept[i])
            .collect();
        valleys.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        for valley in valleys.into_iter().take(VALLEYS) {
            let (mut low, mut high) = (valley.angle - width, valley.angle + width);
            if at(low).slope > 0.0 || at(high).slope < 0.0 {
                continue;
            }
            loop {
                let middle = at(0.5 * (low + high));
                best = nearer(best, middle);
                if middle.angle <= low || middle.angle >= high {
                    break;
                }
                if middle.slope <= 0.0 {
                    low = middle.angle;
                } else {
                    high = middle.angle;
                }
            }
        }
        let (sin, cos) = best.angle.sin_cos();
        let local = DVec3::new(cos * best.met.radius, sin * best.met.radius, best.met.height);
        Nearest { local, distance: best.distance }
    }

    /// The closest point of a segment between two points of the half-plane, given as radius and height.
    pub fn of_segment(&self, out: DVec3, ends: [[f64; 2]; 2]) -> CurvePoint {
        let [a, b] = ends.map(|[radius, height]| self.foot + out * radius + self.up * height);
        let along = share_of_segment(a, b);
        // From the nearer end, to keep its digits.
        let (near, from, to, part) =
            if along <= 0.5 { (a, ends[0], ends[1], along) } else { (b, ends[1], ends[0], 1.0 - along) };
        let [radius, height] = [0, 1].map(|k| from[k] + (to[k] - from[k]) * part);
        let far = if along <= 0.5 { b } else { a };
        CurvePoint { way: near + (far - near) * part, radius, height }
    }

    /// The closest point of the parabola from the foot to a rim; the height is proportional to the radius squared.
    pub fn of_parabola(&self, out: DVec3, [rim, height]: [f64; 2]) -> CurvePoint {
        let (across, up) = (out * rim, self.up * height);
        let at = |q: f64| self.foot + across * q + up * (q * q);
        // The derivative of half the squared distance with respect to the fraction of the rim's radius.
        let cubic = [
            self.foot.dot(across),
            across.length_squared() + 2.0 * self.foot.dot(up),
            3.0 * across.dot(up),
            2.0 * up.length_squared(),
        ];
        let mut best = (at(0.0), 0.0);
        for q in rising_zeros(cubic).into_iter().chain([1.0]) {
            let way = at(q);
            if way.length_squared() < best.0.length_squared() {
                best = (way, q);
            }
        }
        CurvePoint { way: best.0, radius: rim * best.1, height: height * best.1 * best.1 }
    }

    /// The closest point of a circle in the half-plane whose center has height 0.
    pub fn of_circle(&self, out: DVec3, major: f64, minor: f64) -> CurvePoint {
        let (middle, axes) = (self.foot + out * major, [out * minor, self.up * minor]);
        let [cos, sin] = turn_of_ellipse(middle, axes);
        CurvePoint { way: middle + axes[0] * cos + axes[1] * sin, radius: major + minor * cos, height: minor * sin }
    }
}

fn nearer(a: Sample, b: Sample) -> Sample {
    if b.distance < a.distance { b } else { a }
}

/// The fraction along a segment of its point closest to the origin.
fn share_of_segment(a: DVec3, b: DVec3) -> f64 {
    let along = b - a;
    let size = along.abs().max_element();
    if size == 0.0 {
        return 0.0;
    }
    // In units of the segment, to avoid underflow of squares.
    let unit = along / size;
    (-a.dot(unit) / unit.length_squared() / size).clamp(0.0, 1.0)
}

/// The zeros in [0, 1] at which a cubic, given by its coefficients, changes from negative to positive. Between
/// stationary points there is at most one.
fn rising_zeros([a, b, c, d]: [f64; 4]) -> Vec<f64> {
    let value = |q: f64| a + q * (b + q * (c + q * d));
    let mut ends = vec![0.0];
    // The slope is b + 2 c q + 3 d q².
    let root = (c * c - 3.0 * b * d).max(0.0).sqrt();
    let sum = -(c + root.copysign(c));
    let mut turns = [sum / (3.0 * d), b / sum];
    turns.sort_unstable_by(f64::total_cmp);
    ends.extend(turns.into_iter().filter(|q| *q > 0.0 && *q < 1.0));
    ends.push(1.0);
    let mut found = Vec::new();
    for pair in ends.windows(2) {
        let (mut low, mut high) = (pair[0], pair[1]);
        if value(low) > 0.0 || value(high) < 0.0 {
            continue;
        }
        // Enough bisections to exhaust all f64; usually 60 suffice.
        for _ in 0..1100 {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if value(middle) <= 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        found.push(low);
    }
    found
}

/// Cosine and sine of the parameter at which an ellipse, given by its center and two conjugate radii, is closest to the
/// origin.
fn turn_of_ellipse(middle: DVec3, [a, b]: [DVec3; 2]) -> [f64; 2] {
    // The rotation that makes the radii orthogonal (Jacobi 1846).
    let (aa, bb, ab) = (a.length_squared(), b.length_squared(), a.dot(b));
    let twice = (2.0 * ab).atan2(aa - bb);
    let (sin, cos) = (0.5 * twice).sin_cos();
    let axes = [a * cos + b * sin, b * cos - a * sin];
    let lengths = axes.map(DVec3::length);
    let [x, y] = [0, 1].map(|i| if lengths[i] > 0.0 { -middle.dot(axes[i]) / lengths[i] } else { 0.0 });
    // The ellipsoid whose third axis equals the shorter of the two has its closest point on their ellipse, too.
    let least = lengths[0].min(lengths[1]);
    let unit = of_ellipsoid(DVec3::new(lengths[0], lengths[1], least), DVec3::new(x, y, 0.0));
    [unit.x * cos - unit.y * sin, unit.x * sin + unit.y * cos]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubics_rise_through_zero_where_they_are_said_to() {
        assert_eq!(rising_zeros([-0.5, 1.0, 0.0, 0.0]), [0.5]);
        assert!(rising_zeros([0.5, -1.0, 0.0, 0.0]).is_empty());
        // (q − 1/4) (q − 1/2) (q − 3/4)
        let found = rising_zeros([-3.0 / 32.0, 11.0 / 16.0, -1.5, 1.0]);
        assert!(found.len() == 2 && (found[0] - 0.25).abs() < 1e-14 && (found[1] - 0.75).abs() < 1e-14, "{found:?}");
    }

    #[test]
    fn ellipses_of_conjugate_radii_are_nearest_where_no_other_turn_is_nearer() {
        let [a, b] = [DVec3::new(2.0, 0.3, 0.1), DVec3::new(1.5, 0.5, -0.4)];
        for i in 0..200 {
            let place = |by: f64| (f64::from(i) * by).sin() * 2.0;
            let middle = DVec3::new(place(1.1), place(2.3), place(3.7));
            let away = |cos: f64, sin: f64| (middle + a * cos + b * sin).length();
            let [cos, sin] = turn_of_ellipse(middle, [a, b]);
            assert!((cos.hypot(sin) - 1.0).abs() < 1e-14);
            let least = (0..5000).map(|n| (f64::from(n) * TAU / 5000.0).sin_cos()).map(|(s, c)| away(c, s));
            let least = least.fold(f64::INFINITY, f64::min);
            assert!(away(cos, sin) <= least + 1e-14 && away(cos, sin) > least - 1e-2, "{i}");
        }
    }
}
