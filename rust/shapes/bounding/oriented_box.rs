//! Boxes along axes of their own.

use super::{Across, Line, Volume};
use crate::math::DVec3;
use crate::math::robust::UNIT;

/// What lies between three pairs of planes that are at right angles to within rounding.
///
/// The axes are found after Larsson and Källberg ("Fast Computation of Tight-Fitting Oriented Bounding Boxes", 2011):
/// from points that are farthest along 13 fixed directions comes a large triangle, and on it two tetrahedra; each edge
/// of their faces, with the face's normal, proposes axes, and so do the coordinates' own. The box of least surface is
/// kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientedBox {
    /// A point that heights count from.
    pub centre: DVec3,
    /// Of unit length.
    pub axes: [DVec3; 3],
    /// Along each axis, from where to where it goes.
    pub spans: [[f64; 2]; 3],
    /// Bounds every coordinate relative to the centre.
    pub radius: f64,
}

/// The magnitudes of a unit axis's coordinates add up to less.
const SUM: f64 = 1.75;

impl OrientedBox {
    /// The box around points along given axes of unit length.
    pub fn along(axes: [DVec3; 3], points: &[DVec3]) -> Option<Self> {
        let (min, max) = points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), &p| (a.min(p), b.max(p)));
        let centre = min / 2.0 + max / 2.0;
        let radius = (max - centre).max(centre - min).max_element() * (1.0 + 4.0 * UNIT);
        let mut spans = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        for &point in points {
            for (axis, span) in axes.iter().zip(&mut spans) {
                let height = axis.dot(point - centre);
                // The difference errs by uR, products and sums by 4u of what they may be.
                let doubt = 8.0 * UNIT * SUM * radius;
                *span = [span[0].min(height - doubt), span[1].max(height + doubt)];
            }
        }
        (!points.is_empty()).then_some(Self { centre, axes, spans, radius })
    }

    fn sides(&self) -> [f64; 3] {
        self.spans.map(|[low, high]| high - low)
    }
}

/// The axes along an edge of a triangle and its normal.
fn frame(edge: DVec3, normal: DVec3) -> Option<[DVec3; 3]> {
    let (x, y) = (edge.try_normalize()?, normal.try_normalize()?);
    // Of a sliver the normal may lean: at right angles again.
    let y = (y - x * x.dot(y)).try_normalize()?;
    Some([x, y, x.cross(y)])
}

/// Axes that edges and normals of large triangles on the points propose.
fn proposals(points: &[DVec3]) -> (Vec<[DVec3; 3]>, Vec<DVec3>) {
    let farthest = |way: &dyn Fn(DVec3) -> f64| {
        points.iter().copied().max_by(|&a, &b| way(a).total_cmp(&way(b))).unwrap_or(DVec3::ZERO)
    };
    let mut pairs = Vec::new();
    for normal in super::Slabs::<13>::NORMALS {
        pairs.push([farthest(&|p| normal.dot(p)), farthest(&|p| -normal.dot(p))]);
    }
    let extreme: Vec<DVec3> = pairs.iter().flatten().copied().collect();
    let longest = pairs.iter().max_by(|a, b| (a[0] - a[1]).length_squared().total_cmp(&(b[0] - b[1]).length_squared()));
    let Some(&[p, q]) = longest else { return (Vec::new(), extreme) };
    let Some(along) = (q - p).try_normalize() else { return (Vec::new(), extreme) };
    let r = farthest(&|x| (x - p - along * along.dot(x - p)).length_squared());
    let mut all = Vec::new();
    let Some(normal) = (q - p).cross(r - p).try_normalize() else {
        // All on a line.
        let (x, y) = along.any_orthonormal_pair();
        return (vec![[along, x, y]], extreme);
    };
    let mut triangles = vec![[p, q, r]];
    for side in [normal, -normal] {
        let apex = farthest(&|x| side.dot(x - p));
        triangles.extend([[p, q, apex], [q, r, apex], [r, p, apex]]);
    }
    for [a, b, c] in triangles {
        let normal = (b - a).cross(c - a);
        all.extend([b - a, c - b, a - c].into_iter().filter_map(|edge| frame(edge, normal)));
    }
    (all, extreme)
}

impl Volume for OrientedBox {
    type Ready = ();

    fn around(points: &[DVec3]) -> Option<Self> {
        let (mut all, extreme) = proposals(points);
        all.push(DVec3::AXES);
        // The few extreme points choose; all points decide between the choice and the plain box.
        let area = |axes: &[DVec3; 3]| Self::along(*axes, &extreme).map_or(f64::INFINITY, |b| b.half_area());
        let best = all.iter().min_by(|a, b| area(a).total_cmp(&area(b)))?;
        let (turned, plain) = (Self::along(*best, points)?, Self::along(DVec3::AXES, points)?);
        Some(if turned.half_area() < plain.half_area() { turned } else { plain })
    }

    fn ready(_line: &Line) {}

    fn meets(&self, line: &Line, (): &()) -> Option<f64> {
        let relative = line.origin - self.centre;
        // One coordinate of the direction is at least 1.
        let reach = (relative.abs().max_element() + self.radius) * (1.0 + 4.0 * UNIT);
        let (mut enter, mut leave) = (line.t_min, line.t_max);
        for (axis, span) in self.axes.iter().zip(self.spans) {
            let (near, far) = Across::new(relative, line.direction, *axis, SUM).between(span[0], span[1], reach);
            enter = enter.max(near);
            leave = leave.min(far);
        }
        line.window(enter, leave)
    }

    fn contains(&self, point: DVec3) -> bool {
        let relative = point - self.centre;
        let doubt = 8.0 * UNIT * SUM * relative.abs().max_element();
        self.axes.iter().zip(self.spans).all(|(axis, [low, high])| {
            let height = axis.dot(relative);
            low - doubt <= height && height <= high + doubt
        })
    }

    fn half_area(&self) -> f64 {
        let [a, b, c] = self.sides();
        a * (b + c) + b * c
    }

    fn volume(&self) -> f64 {
        let [a, b, c] = self.sides();
        a * b * c
    }
}
