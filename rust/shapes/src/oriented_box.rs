//! Oriented bounding boxes.

use raywright_base::math::DVec3;
use raywright_base::math::robust::UNIT;

/// The 13 directions: axes, space diagonals and face diagonals of a cube, not normalized (Kay and Kajiya, "Ray Tracing
/// Complex Scenes", 1986).
pub const DIRECTIONS: [DVec3; 13] = [
    DVec3::new(1.0, 0.0, 0.0),
    DVec3::new(0.0, 1.0, 0.0),
    DVec3::new(0.0, 0.0, 1.0),
    DVec3::new(1.0, 1.0, 1.0),
    DVec3::new(1.0, 1.0, -1.0),
    DVec3::new(1.0, -1.0, 1.0),
    DVec3::new(-1.0, 1.0, 1.0),
    DVec3::new(1.0, 1.0, 0.0),
    DVec3::new(1.0, -1.0, 0.0),
    DVec3::new(0.0, 1.0, 1.0),
    DVec3::new(0.0, 1.0, -1.0),
    DVec3::new(1.0, 0.0, 1.0),
    DVec3::new(-1.0, 0.0, 1.0),
];

/// The intersection of three slabs that are orthogonal to within rounding.
///
/// The axes are found after Larsson and Källberg ("Fast Computation of Tight-Fitting Oriented Bounding Boxes", 2011).
/// The extreme points along 13 fixed directions give a large triangle and two tetrahedra on it. Each edge of their
/// faces, with the face's normal, proposes axes, as do the coordinate axes. The box of least surface area is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientedBox {
    /// The origin of heights.
    pub centre: DVec3,
    /// The unit axes.
    pub axes: [DVec3; 3],
    /// The interval along each axis.
    pub spans: [[f64; 2]; 3],
}

/// The magnitudes of a unit axis's coordinates sum to less than this.
const SUM: f64 = 1.75;

impl OrientedBox {
    /// A small box around finite points; None for no points.
    pub fn around(points: &[DVec3]) -> Option<Self> {
        let (mut all, extreme) = proposals(points);
        all.push(DVec3::AXES);
        // The few extreme points propose the axes; all points decide between them and the coordinate axes.
        let area = |axes: &[DVec3; 3]| Self::along(*axes, &extreme).map_or(f64::INFINITY, |b| b.half_area());
        let best = all.iter().min_by(|a, b| area(a).total_cmp(&area(b)))?;
        let (turned, plain) = (Self::along(*best, points)?, Self::along(DVec3::AXES, points)?);
        Some(if turned.half_area() < plain.half_area() { turned } else { plain })
    }

    /// The box around points along given unit axes.
    fn along(axes: [DVec3; 3], points: &[DVec3]) -> Option<Self> {
        let (min, max) = points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), &p| (a.min(p), b.max(p)));
        let centre = min / 2.0 + max / 2.0;
        let radius = (max - centre).max(centre - min).max_element() * (1.0 + 4.0 * UNIT);
        let mut spans = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        for &point in points {
            for (axis, span) in axes.iter().zip(&mut spans) {
                let height = axis.dot(point - centre);
                // The difference errs by uR, products and sums by 4u of their bound.
                let doubt = 8.0 * UNIT * SUM * radius;
                *span = [span[0].min(height - doubt), span[1].max(height + doubt)];
            }
        }
        (!points.is_empty()).then_some(Self { centre, axes, spans })
    }

    /// Half the surface area, to which the hit probability of a random ray is proportional.
    fn half_area(&self) -> f64 {
        let [a, b, c] = self.spans.map(|[low, high]| high - low);
        a * (b + c) + b * c
    }
}

/// The axes along an edge of a triangle, its normal, and their cross product.
fn frame(edge: DVec3, normal: DVec3) -> Option<[DVec3; 3]> {
    let (x, y) = (edge.try_normalize()?, normal.try_normalize()?);
    // The normal of a sliver may not be orthogonal to the edge, so orthogonalize it. What remains may be short enough
    // for its rounding to matter; after a second time it is not (Parlett, "The Symmetric Eigenvalue Problem", 1980,
    // 6.9: twice is enough).
    let y = (y - x * x.dot(y)).try_normalize()?;
    let y = (y - x * x.dot(y)).try_normalize()?;
    Some([x, y, x.cross(y)])
}

/// Candidate axes from edges and normals of large triangles, and the extreme points.
fn proposals(points: &[DVec3]) -> (Vec<[DVec3; 3]>, Vec<DVec3>) {
    let farthest = |way: &dyn Fn(DVec3) -> f64| {
        points.iter().copied().max_by(|&a, &b| way(a).total_cmp(&way(b))).unwrap_or(DVec3::ZERO)
    };
    let mut pairs = Vec::new();
    for normal in DIRECTIONS {
        pairs.push([farthest(&|p| normal.dot(p)), farthest(&|p| -normal.dot(p))]);
    }
    let extreme: Vec<DVec3> = pairs.iter().flatten().copied().collect();
    let longest = pairs.iter().max_by(|a, b| (a[0] - a[1]).length_squared().total_cmp(&(b[0] - b[1]).length_squared()));
    let Some(&[p, q]) = longest else { return (Vec::new(), extreme) };
    let Some(along) = (q - p).try_normalize() else { return (Vec::new(), extreme) };
    let r = farthest(&|x| (x - p - along * along.dot(x - p)).length_squared());
    let mut all = Vec::new();
    let Some(normal) = (q - p).cross(r - p).try_normalize() else {
        // All points are collinear.
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use raywright_base::math::DoubleDouble;

    fn coordinate() -> impl Strategy<Value = f64> {
        prop_oneof![-1.0..1.0f64, (-3i32..=3).prop_map(f64::from), (-1.0..1.0f64).prop_map(|x| x * 1e-6)]
    }

    fn point() -> impl Strategy<Value = DVec3> {
        [coordinate(), coordinate(), coordinate()].prop_map(DVec3::from_array)
    }

    /// Generic points, or thin and diagonal clouds, near the origin or far from it.
    fn cloud() -> impl Strategy<Value = Vec<DVec3>> {
        let shift = prop_oneof![Just(DVec3::ZERO), Just(DVec3::new(1e3, -2e6, 5.0)), point()];
        let squeeze = prop_oneof![Just(0.0), Just(1e-9), Just(1.0)];
        (prop::collection::vec(point(), 1..30), shift, point(), squeeze).prop_map(|(points, shift, axis, squeeze)| {
            let axis = axis.try_normalize().unwrap_or(DVec3::X);
            let thin = |p: DVec3| shift + axis * p.dot(axis) + (p - axis * p.dot(axis)) * squeeze;
            points.into_iter().map(thin).collect()
        })
    }

    /// Return whether a point's heights along the axes, in 32 digits, are within the spans.
    fn holds(turned: &OrientedBox, p: DVec3) -> bool {
        turned.axes.iter().zip(turned.spans).all(|(n, [low, high])| {
            let height = (0..3).fold(DoubleDouble::ZERO, |sum, i| {
                sum + DoubleDouble::difference(p[i], turned.centre[i]) * DoubleDouble::from(n[i])
            });
            DoubleDouble::from(low) <= height && height <= DoubleDouble::from(high)
        })
    }

    /// Return whether axes are orthonormal.
    fn are_orthonormal(axes: &[DVec3; 3]) -> bool {
        (0..3).all(|i| (axes[i].length() - 1.0).abs() < 1e-14 && axes[i].dot(axes[(i + 1) % 3]).abs() < 1e-14)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(3000))]
        #[test]
        fn points_are_inside_of_what_is_around_them(points in cloud()) {
            let turned = OrientedBox::around(&points).unwrap();
            prop_assert!(points.iter().all(|&p| holds(&turned, p)));
            prop_assert!(are_orthonormal(&turned.axes));
        }
    }

    #[test]
    fn three_points_almost_on_a_line_have_axes_at_right_angles() {
        let points = [
            DVec3::new(-7.309689497994247e-8, 7.739302646373153e-8, 0.03516246177659127),
            DVec3::new(1.397889860017682e-11, -1.480048187538151e-11, -6.724396266659991e-6),
            DVec3::new(-1.2964641838066503e-11, 1.3726614094095293e-11, 6.236499145460257e-6),
        ];
        assert!(are_orthonormal(&OrientedBox::around(&points).unwrap().axes));
        // For any direction and error of the normal.
        for lean in [0.0, 0.5, 1.0 - 1e-8, 1.0 - 1e-15] {
            let (x, other) = (DVec3::new(1e-9, 3.0, -2.0), DVec3::new(0.3, 0.2, 1.0));
            let normal = x.normalize() * lean + other * (1.0 - lean);
            assert!(are_orthonormal(&frame(x, normal).unwrap()), "{lean}");
        }
    }

    #[test]
    fn a_diagonal_rod_fills_a_turned_box_better_than_a_box() {
        let rod: Vec<DVec3> = (0..40)
            .map(|i| DVec3::ONE * f64::from(i) + DVec3::new(f64::from(i % 3), f64::from(i % 2), 0.0) * 0.1)
            .collect();
        let plain = OrientedBox::along(DVec3::AXES, &rod).unwrap();
        assert!(OrientedBox::around(&rod).unwrap().half_area() < 0.02 * plain.half_area());
    }

    #[test]
    fn a_cube_has_its_surface() {
        let corner = |i: i32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) * 2.0 + 3.0;
        let cube: Vec<DVec3> = (0..8).map(corner).collect();
        assert!((OrientedBox::around(&cube).unwrap().half_area() / 12.0 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn one_point_has_a_box_and_none_has_none() {
        assert_eq!(OrientedBox::around(&[]), None);
        let one = DVec3::new(1.0, 2.0, 3.0);
        assert!(holds(&OrientedBox::around(&[one]).unwrap(), one));
    }
}
