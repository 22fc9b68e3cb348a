//! The ellipsoid.

use super::closest_points::{of_ellipsoid, of_ellipsoid_under};
use super::line::Line;
use super::meeting::{ball, ball_surface, tell};
use super::solid::{Meets, Solid};
use super::sphere::{Sphere, ellipsoid_area_under, globe, longitude_latitude};
use super::{Bounds, Candidate, Carried, Closest, Drawn, Point, Shape};
use raywright_base::math::robust::UNIT;
use raywright_base::math::{Affine, DVec3, Number, Ray, Triple, ellipsoid_area};
use raywright_base::sampling::warp::{UNIFORM_SPHERE_PDF, uniform_sphere};

/// A sphere scaled along the axes; closed.
///
/// Its surface parameters are those of the unscaled [`Sphere`].
#[derive(Clone, Debug, PartialEq)]
pub struct Ellipsoid {
    /// Its center.
    pub center: DVec3,
    /// The semi-axes along x, y and z, each above 0.
    pub semi_axes: DVec3,
}

impl Ellipsoid {
    /// The point at given surface parameters.
    ///
    /// Each coordinate of the unit vector errs by 4 UNIT; scaling and the last sum add one UNIT each.
    fn at(&self, uv: [f64; 2]) -> Point {
        let (unit, [du, dv]) = globe(uv);
        let a = self.semi_axes;
        let position = self.center + unit * a;
        let error = UNIT * (position.abs().max_element() + 6.0 * a.max_element());
        // Scaled by the shortest axis, which avoids overflow.
        let inverse = a.min_element() / a;
        let (n, dn) = (unit * inverse, [du * inverse, dv * inverse]);
        let length = n.length();
        let normal = n / length;
        let dn = dn.map(|d| (d - normal * normal.dot(d)) / length);
        Point { position, error, normal, uv, dp: [du * a, dv * a], dn }
    }

    /// Factors that scale the ellipsoid to a sphere, and that sphere's radius. Each factor is the product of the other
    /// two axes, and the radius that of all three, which avoids division.
    fn rounding<N: Number>(&self) -> ([N; 3], N) {
        let [x, y, z] = self.semi_axes.to_array().map(N::of);
        let by = [y.times(&z), z.times(&x), x.times(&y)];
        let radius = by[0].times(&x);
        (by, radius)
    }

    /// The ratio of its area element to the unit sphere's at a point of that sphere.
    fn stretch(&self, unit: DVec3) -> f64 {
        let [x, y, z] = self.semi_axes.to_array();
        (unit * DVec3::new(y * z, z * x, x * y)).length()
    }
}

/// Each coordinate times its own factor.
fn scaled<N: Number>(v: &Triple<N>, by: &[N; 3]) -> Triple<N> {
    Triple(std::array::from_fn(|i| v.0[i].times(&by[i])))
}

impl Solid for Ellipsoid {
    fn meets<N: Number>(&self, line: &Line<N>) -> Option<Meets<N>> {
        let Line { origin, direction, unit } = line.from(self.center);
        let (by, radius) = self.rounding();
        let line = Line { origin: scaled(&origin, &by), direction: scaled(&direction, &by), unit };
        ball(&line, &radius.times(&line.unit))
    }

    #[inline(always)]
    fn surface<N: Number>(&self, _: usize, point: &Triple<N>, unit: &N) -> N {
        let (by, radius) = self.rounding();
        ball_surface(&scaled(point, &by), &radius.times(unit))
    }

    fn coordinates(&self, _: usize, point: DVec3) -> [f64; 2] {
        longitude_latitude(point / self.semi_axes)
    }

    fn reference(&self) -> DVec3 {
        self.center
    }
}

impl Shape for Ellipsoid {
    fn closest(&self, place: DVec3) -> Option<Closest> {
        let unit = of_ellipsoid(self.semi_axes, place - self.center);
        Some(Closest { position: self.center + unit * self.semi_axes, uv: longitude_latitude(unit) })
    }

    fn closest_under(&self, to_world: &Affine, to_object: &Affine, place: DVec3) -> Option<Closest> {
        let (position, unit) = of_ellipsoid_under([to_world, to_object], [self.center, self.semi_axes], place);
        Some(Closest { position, uv: longitude_latitude(unit) })
    }

    fn bounds(&self) -> Bounds {
        // One rounding each.
        Bounds {
            min: (self.center - self.semi_axes).to_array().map(f64::next_down).into(),
            max: (self.center + self.semi_axes).to_array().map(f64::next_up).into(),
        }
    }

    fn support(&self, d: DVec3) -> f64 {
        let size = (d.abs() * self.center.abs()).element_sum();
        let reach = (d * self.semi_axes).length();
        d.dot(self.center) + reach + UNIT * (4.0 * size + 8.0 * reach)
    }

    fn meet(&self, ray: &Ray, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
        self.meet_carried(&Carried::Ray(ray), met)
    }

    fn meet_carried(&self, ray: &Carried<'_>, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
        tell(self, ray, met)
    }

    fn point(&self, _: &Ray, _: f64, uv: [f64; 2]) -> Point {
        self.at(uv)
    }

    fn area(&self) -> f64 {
        let [x, y, z] = self.semi_axes.to_array();
        ellipsoid_area([y * z, z * x, x * y])
    }

    fn area_under(&self, map: &Affine) -> f64 {
        ellipsoid_area_under(map, self.semi_axes)
    }

    /// Uniform on the unscaled sphere, so denser where the ellipsoid is more curved.
    fn sample(&self, u: [f64; 2]) -> Option<Drawn> {
        let unit = uniform_sphere(u);
        let point = self.at(longitude_latitude(unit));
        Some(Drawn { point, pdf: UNIFORM_SPHERE_PDF / self.stretch(unit) })
    }

    /// Uniform in the cone that the unscaled sphere subtends, mapped back.
    fn sample_from(&self, place: DVec3, u: [f64; 2]) -> Option<Drawn> {
        let place = (place - self.center) / self.semi_axes;
        let Drawn { point, pdf } = Sphere::UNIT.sample_from(place, u)?;
        let way = point.position - place;
        Some(Drawn { point: self.at(point.uv), pdf: pdf * self.crowding(way) })
    }

    fn pdf_from(&self, place: DVec3, direction: DVec3) -> f64 {
        let (place, way) = ((place - self.center) / self.semi_axes, direction / self.semi_axes);
        let pdf = Sphere::UNIT.pdf_from(place, way);
        if pdf > 0.0 { pdf * self.crowding(way) } else { 0.0 }
    }
}

impl Ellipsoid {
    /// The solid angle of the sphere's space per solid angle of object space: |S⁻¹ d|⁻³ / det S for a unit vector d.
    /// The argument is S⁻¹ d, of any length.
    fn crowding(&self, way: DVec3) -> f64 {
        let stretched = (way.normalize() * self.semi_axes).length();
        stretched.powi(3) / self.semi_axes.element_product()
    }
}
