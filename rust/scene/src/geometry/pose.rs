//! Pose of an instance: the map from a prototype's space to its parent space, applied to rays and points.
//!
//! A ray enters the prototype's space by a matrix `M` and the map's translation `s`: `o' = M (o − s)`, `d' = M d`. The
//! direction is not normalized, so `t` is the same in both spaces to within rounding. `M` is the inverse of the map's
//! linear part `L`, rounded once. The transformed ray decides the hit; its `t` is then recomputed with `L`
//! ([`super::instance_ray`]).
//!
//! Error bounds, with u = 2⁻⁵³ and κ the greatest row sum of |L| |M|. κ is at least 1, and at most 3 for a rotation. A
//! coordinate of `o'` has an error below 4u (|M| |o − s|), which is 4uκ |o − s| in world space; the same holds for
//! `d'`. Three products and their sum take five roundings, and the difference one. A point `p` of the prototype is at
//! `L p + s`. The residual `R = 1 − L M` measures how far `M` is from the inverse of `L`: for rays the point is
//! displaced by `|R| |L p|`. `R` is computed to within 4uκ.

use super::plane_point::PlanePoint;
use crate::{ShadingPoint, SurfacePoint};
use raywright_base::math::robust::UNIT;
use raywright_base::math::{Affine, DVec3, Ray, Singular};
use raywright_shapes::Bounds;

/// The rows of a linear map.
pub type Rows = [DVec3; 3];

/// A map from a prototype's space to its parent space, prepared for rays.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Pose {
    /// The inverse of the linear part.
    inverse: Rows,
    /// Position of the prototype's origin.
    shift: DVec3,
    /// The linear part, used only at hits.
    linear: Rows,
}

/// Up to this condition number the quick inverse is as accurate as the exact one.
const WELL_CONDITIONED: f64 = 64.0;

/// The largest accepted κ. From up to 2⁷ sizes of an instance away, rays that hit it also hit its box
/// ([`Pose::around`]), with an error below 2⁻³¹ of that distance.
///
/// κ does not depend on a scaling of the prototype's axes: for a scaling followed by a rotation it is at most 3.
pub const MOST_CONDITION: f64 = (1 << 20) as f64;

#[inline(always)]
fn times(rows: &Rows, v: DVec3) -> DVec3 {
    DVec3::new(rows[0].dot(v), rows[1].dot(v), rows[2].dot(v))
}

#[inline(always)]
fn abs(rows: &Rows) -> Rows {
    rows.map(DVec3::abs)
}

/// The greatest row sum of |a| |b|.
#[inline(always)]
fn condition(a: &Rows, b: &Rows) -> f64 {
    let sums = times(&abs(b), DVec3::ONE);
    times(&abs(a), sums).max_element()
}

/// Inverts a linear map: to within some roundings of its largest entries if it is well conditioned, and each entry to
/// within an ulp otherwise.
///
/// # Errors
/// If it is singular, decided exactly, or f64 cannot hold the inverse.
#[inline]
pub fn inverse(rows: &Rows) -> Result<Rows, Singular> {
    let [a, b, c] = *rows;
    let columns = [b.cross(c), c.cross(a), a.cross(b)];
    let determinant = a.dot(columns[0]);
    let [x, y, z] = columns.map(|column| column / determinant);
    let inverse = [DVec3::new(x.x, y.x, z.x), DVec3::new(x.y, y.y, z.y), DVec3::new(x.z, y.z, z.z)];
    let largest = a.abs().max(b.abs()).max(c.abs()).max_element();
    // In this range products of three neither overflow nor underflow noticeably.
    if largest > 1e-75 && largest < 1e75 && condition(rows, &inverse) <= WELL_CONDITIONED {
        return Ok(inverse);
    }
    inverse_of_any(rows)
}

#[cold]
#[inline(never)]
fn inverse_of_any(rows: &Rows) -> Result<Rows, Singular> {
    Affine::new(*rows, DVec3::ZERO).inverse().map(|inverse| inverse.rows)
}

impl Pose {
    /// Creates the pose of a map by its rows, each three numbers of the linear part and one of the translation.
    ///
    /// # Errors
    /// If it has no inverse, a number is not finite, or κ is more than [`MOST_CONDITION`].
    #[inline]
    pub fn new(matrix: &[[f64; 4]; 3]) -> Result<Self, Singular> {
        let (rows, shift) = parts(matrix);
        if !shift.is_finite() || !rows.iter().all(|row| row.is_finite()) {
            return Err(Singular::NotFinite);
        }
        let inverse = inverse(&rows)?;
        let kappa = condition(&rows, &inverse);
        if kappa > MOST_CONDITION {
            return Err(Singular::IllConditioned(kappa, MOST_CONDITION));
        }
        Ok(Self { linear: rows, inverse, shift })
    }

    /// Creates a translation.
    #[inline(always)]
    pub const fn shifted(shift: DVec3) -> Self {
        Self { linear: DVec3::AXES, inverse: DVec3::AXES, shift }
    }

    /// The translation, if the map is nothing else.
    pub fn shift_alone(&self) -> Option<DVec3> {
        (self.linear == DVec3::AXES).then_some(self.shift)
    }

    /// Transforms a ray into the prototype's space.
    #[inline(always)]
    pub fn enter(&self, ray: &Ray) -> Ray {
        Ray {
            origin: times(&self.inverse, ray.origin - self.shift),
            direction: times(&self.inverse, ray.direction),
            // The prototype numbers its own primitives.
            misses: [Ray::NO_TRIANGLE; 2],
            ..*ray
        }
    }

    /// Maps a point of a plane to the parent space.
    #[inline]
    pub fn plane_point(&self, plane: &PlanePoint) -> PlanePoint {
        plane.under(&self.linear, &self.inverse, self.shift)
    }

    /// The linear map to the prototype's space, and the translation that is subtracted first.
    pub fn to_prototype(self) -> (Rows, DVec3) {
        (self.inverse, self.shift)
    }

    /// Bounds of a mapped box, enlarged by 2⁻²² of its size.
    ///
    /// The margin covers the error of `t` in the prototype's space, which is 2⁻²⁶ of nine radii at most
    /// ([`raywright_shapes::triangle::EdgeRay::T_ERROR`]), and the ray's own roundings, 8uκ of its distance. So every
    /// ray that hits in the prototype's space also hits this box, if κ is at most 16 (box tests tolerate that at any
    /// distance), or if κ times the distance is at most 2²⁷ times the instance's size. Beyond that, accelerators may
    /// disagree on hits that graze within rounding.
    pub fn around(&self, bounds: &Bounds) -> Bounds {
        carried(&self.linear, self.shift, bounds)
    }

    /// Maps a point of the prototype's surface to the parent space.
    ///
    /// Let M be the size of the surface, known from the point's error: 8ε M for a triangle, and at least that share of
    /// the coordinates themselves. The mapped point has the error it had before, the residual's, and the roundings made
    /// here. A leaving ray is transformed back with an error of 8uκ |L| M along the surface's extent. In total 32uκ |L|
    /// M are allowed.
    pub fn point(&self, point: &SurfacePoint) -> SurfacePoint {
        let rows = self.linear;
        let kappa = condition(&rows, &self.inverse);
        let residual = (0..3).fold(0.0f64, |most, i| {
            let product: DVec3 = (0..3).map(|k| self.inverse[k] * rows[i][k]).sum();
            most.max((DVec3::AXES[i] - product).abs().element_sum())
        });
        let norm = rows.iter().map(|row| row.abs().element_sum()).fold(0.0, f64::max);
        let position = times(&rows, point.position) + self.shift;
        let size = point.position.abs().max_element().max(point.error / (16.0 * UNIT));
        let error = 2.0 * norm * point.error
            + (residual + 32.0 * UNIT * kappa) * norm * size
            + 4.0 * UNIT * position.abs().max(self.shift.abs()).max_element();
        // Normals transform by the inverse transpose and keep their side.
        let turned = |n: DVec3| {
            let n = self.inverse[0] * n.x + self.inverse[1] * n.y + self.inverse[2] * n.z;
            let n = n / n.abs().max_element();
            n / n.length()
        };
        let (normal, shading) = (turned(point.normal), point.shading_normal);
        let shading_normal = if shading == point.normal { normal } else { turned(shading) };
        SurfacePoint { position, error, normal, shading_normal, ..*point }
    }
}

impl Pose {
    /// Derivatives of a unit normal in the parent space, from those in the prototype's space.
    fn turning(&self, normal: DVec3, dn: [DVec3; 2]) -> [DVec3; 2] {
        let across = |n: DVec3| self.inverse[0] * n.x + self.inverse[1] * n.y + self.inverse[2] * n.z;
        // Derivative of a normalized vector: the mapped derivative without its component along the normal, over the
        // mapped normal's length.
        let outside = across(normal);
        let length = outside.length();
        let outside = outside / length;
        dn.map(|change| {
            let change = across(change) / length;
            change - outside * change.dot(outside)
        })
    }

    /// Ratio of solid angle in the prototype's space to that in the parent space, about a unit direction of the latter.
    pub(crate) fn crowding(&self, direction: DVec3) -> f64 {
        let [a, b, c] = self.inverse;
        a.dot(b.cross(c)).abs() / times(&self.inverse, direction).length().powi(3)
    }

    /// The affine map.
    pub(crate) fn map(&self) -> Affine {
        Affine::new(self.linear, self.shift)
    }

    /// Maps the shading data of the prototype to the parent space, where the mapped surface point is `point`.
    pub(super) fn shading_point(&self, within: ShadingPoint, point: SurfacePoint) -> ShadingPoint {
        let rows = self.linear;
        let volume = rows[0].dot(rows[1].cross(rows[2])).abs();
        ShadingPoint {
            point,
            dp: within.dp.map(|d| times(&rows, d)),
            dn: self.turning(within.point.shading_normal, within.dn),
            scale: within.scale / volume.cbrt(),
            ..within
        }
    }
}

/// Splits a matrix into the rows of its linear part and its translation.
#[inline(always)]
fn parts(matrix: &[[f64; 4]; 3]) -> (Rows, DVec3) {
    (matrix.map(|[x, y, z, _]| DVec3::new(x, y, z)), DVec3::from_array(matrix.map(|row| row[3])))
}

/// Bounds of a box under a map; see [`Pose::around`].
pub fn carried_by(matrix: &[[f64; 4]; 3], bounds: &Bounds) -> Bounds {
    let (rows, shift) = parts(matrix);
    carried(&rows, shift, bounds)
}

fn carried(rows: &Rows, shift: DVec3, bounds: &Bounds) -> Bounds {
    const ROOM: f64 = 1.0 / (1u64 << 22) as f64;
    let sizes = abs(rows);
    let (centre, half) = (bounds.min / 2.0 + bounds.max / 2.0, bounds.max / 2.0 - bounds.min / 2.0);
    let middle = times(rows, centre) + shift;
    let roundings = 16.0 * UNIT * (times(&sizes, centre.abs()) + shift.abs());
    // An infinite extent stays infinite along each axis it contributes to; zero times infinity must give zero.
    let part = |row: DVec3| DVec3::select(row.cmpeq(DVec3::ZERO), DVec3::ZERO, row * half).element_sum();
    let reach = DVec3::from_array(sizes.map(part)) * (1.0 + 16.0 * UNIT);
    let room = times(&sizes, DVec3::splat(half.max_element().min(f64::MAX))) * ROOM;
    let away = reach + room + roundings;
    if bounds.is_finite() {
        Bounds { min: middle - away, max: middle + away }
    } else {
        Bounds { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY }
    }
}

/// Interpolates two matrices at a time from 0 to 1, so that every point moves on a straight line.
#[inline]
pub fn between(start: &[[f64; 4]; 3], end: &[[f64; 4]; 3], time: f64) -> [[f64; 4]; 3] {
    if time >= 1.0 {
        return *end;
    }
    // NaN counts as 0.
    let time = if time > 0.0 { time } else { 0.0 };
    std::array::from_fn(|i| std::array::from_fn(|j| start[i][j] + (end[i][j] - start[i][j]) * time))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vector(size: f64) -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-size..size).prop_map(DVec3::from_array)
    }

    /// Rotated, sheared, mirrored, and scaled from 1e-6 to 1e6 per axis; up to 1e7 away.
    fn matrix() -> impl Strategy<Value = [[f64; 4]; 3]> {
        let scale = prop::array::uniform3((-6.0..6.0f64, any::<bool>()));
        (prop::array::uniform3(vector(1.0)), scale, vector(1.0), -7.0..7.0f64).prop_map(|(rows, scale, shift, far)| {
            let scale = scale.map(|(power, mirrored)| 10f64.powf(power) * if mirrored { -1.0 } else { 1.0 });
            let shift = shift * 10f64.powf(far);
            std::array::from_fn(|i| {
                let row = rows[i] + DVec3::AXES[i];
                [row.x * scale[0], row.y * scale[1], row.z * scale[2], shift[i]]
            })
        })
    }

    fn inside(bounds: &Bounds, u: DVec3) -> DVec3 {
        bounds.min + (bounds.max - bounds.min) * u
    }

    fn holds(bounds: &Bounds, p: DVec3) -> bool {
        p.cmpge(bounds.min).all() && p.cmple(bounds.max).all()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4096))]

        #[test]
        fn inverses_are_those_of_twice_the_digits(matrix in matrix()) {
            let (rows, _) = parts(&matrix);
            let Ok(inverse) = inverse(&rows) else { return Err(TestCaseError::reject("singular")) };
            let exact = Affine::new(rows, DVec3::ZERO).inverse().unwrap().rows;
            let largest = exact.iter().map(|row| row.abs().max_element()).fold(0.0, f64::max);
            let kappa = condition(&rows, &exact);
            for (a, b) in inverse.iter().zip(&exact) {
                let bound = 16.0 * UNIT * kappa.min(WELL_CONDITIONED).powi(2) * largest;
                prop_assert!((*a - *b).abs().max_element() <= bound);
            }
        }

        #[test]
        fn a_ray_taken_over_and_a_point_taken_back_meet(
            matrix in matrix(), p in vector(3.0), way in vector(1.0), t in 0.1..10.0f64,
        ) {
            let Ok(pose) = Pose::new(&matrix) else { return Err(TestCaseError::reject("singular")) };
            // A point of the prototype with the error of one on a triangle of this size.
            let own = SurfacePoint {
                position: p, error: 16.0 * UNIT * 3.0, normal: DVec3::X, shading_normal: DVec3::X,
                shape: 0, inner: None,
            };
            let world = pose.point(&own);
            // The exact position, in double-double precision.
            let map = Affine::new(pose.inverse, DVec3::ZERO).inverse().unwrap();
            let exact = Affine::new(map.rows, pose.shift).point(p);
            let off = (world.position - exact).abs().max_element();
            prop_assert!(off <= world.error, "{} {}", world.position, world.error);
            // A ray towards the point passes it in the prototype's space by at most the reported error, which is small.
            let ray = Ray::new(world.position - way * t, way);
            let taken = pose.enter(&ray);
            let off = (taken.origin + taken.direction * t - p).abs();
            let spread = abs(&pose.inverse).map(|row| row.element_sum() * world.error);
            let started = times(&abs(&pose.inverse), (ray.origin - pose.shift).abs() + (ray.direction * t).abs());
            prop_assert!(off.cmple(DVec3::from_array(spread) + started * 8.0 * UNIT).all(), "{off}");
            prop_assert!((world.normal.length() - 1.0).abs() < 1e-12);
        }

        #[test]
        fn boxes_hold_what_they_held(
            matrix in matrix(), a in vector(2.0), b in vector(2.0), u in prop::array::uniform3(0.0..=1.0f64),
        ) {
            let bounds = Bounds { min: a.min(b), max: a.max(b) };
            let Ok(pose) = Pose::new(&matrix) else { return Err(TestCaseError::reject("singular")) };
            let around = pose.around(&bounds);
            let (rows, shift) = parts(&matrix);
            for u in [DVec3::from_array(u), DVec3::ZERO, DVec3::ONE] {
                let p = inside(&bounds, u);
                let (point, exact) = (times(&rows, p) + shift, Affine::new(rows, shift).point(p));
                prop_assert!(holds(&around, exact) && holds(&carried_by(&matrix, &bounds), exact), "{point}");
            }
            // The box of a single point has only the size of roundings.
            let least = pose.around(&Bounds { min: a, max: a });
            let size = times(&abs(&rows), a.abs()) + shift.abs();
            prop_assert!((least.max - least.min).cmple(size * 1e-12 * condition(&rows, &pose.inverse)).all());
        }

        #[test]
        fn what_moves_stays_between_the_ends_of_its_box(
            start in matrix(), end in matrix(), a in vector(2.0), b in vector(2.0),
            u in prop::array::uniform3(0.0..=1.0f64), time in 0.0..=1.0f64
        ) {
            let bounds = Bounds { min: a.min(b), max: a.max(b) };
            let [from, to] = [start, end].map(|matrix| carried_by(&matrix, &bounds));
            let mixed = |a: DVec3, b: DVec3| a + (b - a) * time;
            let box_then = Bounds { min: mixed(from.min, to.min), max: mixed(from.max, to.max) };
            let (rows, shift) = parts(&between(&start, &end, time));
            prop_assert!(holds(&box_then, Affine::new(rows, shift).point(inside(&bounds, DVec3::from_array(u)))));
        }
    }

    #[test]
    fn powers_of_two_and_quarter_turns_are_exact() {
        let matrix = [[0.0, -4.0, 0.0, 3.0], [0.25, 0.0, 0.0, -7.0], [0.0, 0.0, -2.0, 1e6]];
        let pose = Pose::new(&matrix).unwrap();
        assert_eq!(pose.inverse, [DVec3::new(0.0, 4.0, 0.0), DVec3::new(-0.25, 0.0, 0.0), DVec3::new(0.0, 0.0, -0.5)]);
        assert_eq!(between(&matrix, &matrix, 0.3), matrix);
        assert_eq!(between(&matrix, &matrix.map(|row| row.map(|x| x + 1e17)), 1.0)[0][3], 1e17 + 3.0);
    }

    #[test]
    fn what_has_no_inverse_is_told() {
        let flat = [[1.0, 2.0, 3.0, 0.0], [2.0, 4.0, 6.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        assert_eq!(Pose::new(&flat), Err(Singular::ZeroDeterminant));
        assert_eq!(Pose::new(&flat.map(|row| row.map(|x| x / 0.0))), Err(Singular::NotFinite));
        // Shear by this amount: κ is some 4 over the remaining determinant. For scaling by this amount it is 1.
        let sheared = |by: f64| Pose::new(&[[1.0, 1.0, 0.0, 0.0], [1.0, 1.0 + by, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]);
        assert!(sheared(1e-5).is_ok());
        for by in [1e-6, 1e-12, 1e-15] {
            let Err(Singular::IllConditioned(kappa, most)) = sheared(by) else { panic!("{by} is too little") };
            assert!((kappa * by / 4.0 - 1.0).abs() < 0.2 && most == MOST_CONDITION, "{kappa}");
        }
        let scaled = [[1e-15, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1e15, 0.0]];
        assert!(Pose::new(&scaled).is_ok());
    }
}
