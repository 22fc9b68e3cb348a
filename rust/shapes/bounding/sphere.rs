//! The smallest sphere around points.

use super::{Line, Volume};
use crate::math::DVec3;
use crate::math::robust::UNIT;
use std::f64::consts::PI;

/// A ball.
///
/// The smallest one, to within rounding: the point farthest outside joins those that hold the ball, and the smallest
/// ball around these few is found among all that two, three or four of them hold (Welzl, 1991; pivoting after Gärtner,
/// "Fast and Robust Smallest Enclosing Balls", 1999).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundingSphere {
    /// Its centre.
    pub centre: DVec3,
    /// Rounded up.
    pub radius: f64,
}

/// The ball on whose surface some points lie, with its centre in their span.
fn circumscribed(points: &[DVec3]) -> Option<(DVec3, f64)> {
    let first = *points.first()?;
    let edges: Vec<DVec3> = points[1..].iter().map(|&p| p - first).collect();
    let offset = match edges[..] {
        [] => DVec3::ZERO,
        [a] => a / 2.0,
        [a, b] => {
            let normal = a.cross(b);
            let area = normal.length_squared();
            (b.cross(normal) * a.length_squared() + normal.cross(a) * b.length_squared()) / (2.0 * area)
        }
        [a, b, c] => {
            let volume = a.dot(b.cross(c));
            let sum =
                b.cross(c) * a.length_squared() + c.cross(a) * b.length_squared() + a.cross(b) * c.length_squared();
            sum / (2.0 * volume)
        }
        _ => return None,
    };
    let radius = offset.length();
    radius.is_finite().then_some((first + offset, radius))
}

/// The smallest ball around at most five points, among those that some of them hold.
fn smallest(points: &[DVec3]) -> Option<(DVec3, f64, Vec<DVec3>)> {
    let mut best: Option<(DVec3, f64, Vec<DVec3>)> = None;
    for chosen in 1u32..1 << points.len() {
        if chosen.count_ones() > 4 {
            continue;
        }
        let held: Vec<DVec3> = (0..points.len()).filter(|i| chosen >> i & 1 == 1).map(|i| points[i]).collect();
        let Some((centre, radius)) = circumscribed(&held) else { continue };
        let holds = points.iter().all(|p| p.distance(centre) <= radius * (1.0 + 1e-12));
        if holds && best.as_ref().is_none_or(|b| radius < b.1) {
            best = Some((centre, radius, held));
        }
    }
    best
}

impl BoundingSphere {
    /// The ball about a centre that holds points.
    pub fn about(centre: DVec3, points: &[DVec3]) -> Self {
        // A difference errs by u of its coordinates, the length by 3u more.
        let farthest = points.iter().map(|p| p.distance(centre)).fold(0.0, f64::max);
        Self { centre, radius: farthest * (1.0 + 8.0 * UNIT) }
    }
}

impl Volume for BoundingSphere {
    type Ready = ();

    fn around(points: &[DVec3]) -> Option<Self> {
        let mut held = vec![*points.first()?];
        let (mut centre, mut radius) = (held[0], 0.0);
        let mut best = (f64::INFINITY, centre);
        // The radius never shrinks, but where it grows by less than rounding sets of points may come again: a few turns
        // more do no harm.
        for _ in 0..100 {
            let from = |p: &DVec3| p.distance_squared(centre);
            let far = points.iter().copied().max_by(|a, b| from(a).total_cmp(&from(b)))?;
            let distance = far.distance(centre);
            if distance < best.0 {
                best = (distance, centre);
            }
            if distance <= radius * (1.0 + 1e-13) {
                break;
            }
            held.push(far);
            match smallest(&held) {
                Some((c, r, h)) if r >= radius * (1.0 - 1e-12) => (centre, radius, held) = (c, r, h),
                _ => break,
            }
        }
        Some(Self::about(best.1, points))
    }

    fn ready(_line: &Line) {}

    /// With m the centre relative to the origin, the line passes at |m × d| / |d|. A coordinate of m errs by u|m|, so
    /// the cross product by 6u|m||d|, and lengths by some u of themselves: 16u|m||d| is allowed, and as much in the
    /// length along the line.
    fn meets(&self, line: &Line, (): &()) -> Option<f64> {
        let (m, d) = (self.centre - line.origin, line.direction);
        let (length, far) = (d.length(), m.length());
        let room = 16.0 * UNIT * far * length;
        let reach = self.radius * length * (1.0 + 8.0 * UNIT) + room;
        let past = m.cross(d).length();
        if past > reach && past.is_finite() {
            return None;
        }
        let square = d.length_squared();
        // The smaller the past, the longer the chord: both factors rounded so that it is not too short.
        let chord = ((reach - past).max(0.0) * (reach + past)).sqrt() * (1.0 + 8.0 * UNIT);
        let middle = m.dot(d);
        line.window((middle - chord - room) / square, (middle + chord + room) / square)
    }

    fn contains(&self, point: DVec3) -> bool {
        point.distance(self.centre) <= self.radius * (1.0 + 8.0 * UNIT)
    }

    fn half_area(&self) -> f64 {
        2.0 * PI * self.radius * self.radius
    }

    fn volume(&self) -> f64 {
        4.0 / 3.0 * PI * self.radius.powi(3)
    }
}
