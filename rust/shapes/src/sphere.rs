//! The sphere.

use super::closest_points::{of_ellipsoid, of_ellipsoid_under};
use super::line::Line;
use super::meeting::{ball, ball_surface, tell};
use super::solid::{Meet, Meets, Solid};
use super::{Ball, Bounds, Candidate, Carried, Closest, Contact, Drawn, Point, Seen, Shape, Site};
use raywright_base::math::robust::UNIT;
use raywright_base::math::trig::{sin_cos_turn, upper_angle};
use raywright_base::math::{Affine, Bounded, DVec3, Frame, Number, Ray, Triple, at_right_angles, ellipsoid_area};
use raywright_base::sampling::warp::{UNIFORM_SPHERE_PDF, uniform_sphere};
use std::f64::consts::{PI, TAU};

/// All points at one distance from a center; closed.
///
/// u is the longitude about +z from +x, in turns. v is the latitude from the pole at −z to that at +z, in half turns.
#[derive(Clone, Debug, PartialEq)]
pub struct Sphere {
    /// Its center.
    pub center: DVec3,
    /// The radius, above 0.
    pub radius: f64,
}

impl Sphere {
    /// The unit sphere around the origin.
    pub const UNIT: Self = Self { center: DVec3::ZERO, radius: 1.0 };

    /// The point at given surface parameters.
    fn at(&self, uv: [f64; 2]) -> Point {
        let (direction, dn) = globe(uv);
        let Site { position, error, normal } = self.towards(direction);
        Point { position, error, normal, uv, dp: dn.map(|d| d * self.radius), dn }
    }

    /// Sample a point uniformly in the cone that the sphere subtends.
    #[inline(always)]
    fn sight_in(&self, cone: &Cone, u: [f64; 2]) -> Seen {
        // x = 1 − cos θ is uniform in [0, height). sin² θ = x (2 − x) is the product of the cone's sine squared and
        // that of the incidence angle's sine.
        let x = u[0] * cone.height();
        let square = u[0] * cone.part * (2.0 - x);
        let facing = (1.0 - square).max(0.0).sqrt();
        // The angle at the center between reference point and sample: the incidence angle minus θ.
        let cosine = (1.0 - x) * facing + square * cone.sine;
        let across = square.sqrt() * (1.0 - x - cone.sine * facing);
        let [sin, cos] = sin_cos_turn(u[1]);
        let direction = Frame::new(cone.axis).to_world(DVec3::new(across * cos, across * sin, cosine));
        // A unit vector up to rounding: one Newton step is as accurate as a root and a quotient, and has a shorter
        // latency.
        let direction = direction * (1.5 - 0.5 * direction.length_squared());
        Seen { site: self.towards(direction), pdf: 1.0 / (TAU * cone.height()) }
    }

    /// The point in a direction from the center that is a unit vector to within 4 UNIT in each coordinate. The last sum
    /// adds one UNIT.
    #[inline(always)]
    fn towards(&self, direction: DVec3) -> Site {
        let position = self.center + direction * self.radius;
        Site { position, error: UNIT * (position.abs().max_element() + 5.0 * self.radius), normal: direction }
    }

    /// The cone that the sphere subtends from a point; None from inside or on the sphere.
    #[inline]
    fn cone(&self, place: DVec3) -> Option<Cone> {
        let (cone, is_outside) = self.cone_from_outside(place);
        is_outside.then_some(cone)
    }

    /// The same, and whether it is valid.
    #[inline(always)]
    fn cone_from_outside(&self, place: DVec3) -> (Cone, bool) {
        let way = place - self.center;
        let distance = way.length();
        // Rounding may make a point on the sphere appear farther out by this much.
        let rounding = 4.0 * UNIT * (place.abs().max_element() + 5.0 * self.radius);
        let inverse = 1.0 / distance;
        let sine = self.radius * inverse;
        let cosine = ((distance - self.radius) * (distance + self.radius)).sqrt() * inverse;
        let cone = Cone { axis: way * inverse, sine, part: 1.0 / (1.0 + cosine) };
        (cone, distance >= self.radius + rounding)
    }
}

/// The cone of directions that a sphere subtends from an outside point.
struct Cone {
    /// The unit vector from the center to the reference point.
    axis: DVec3,
    /// The sine of the half-angle.
    sine: f64,
    /// 1 / (1 + cos) of the half-angle.
    part: f64,
}

impl Cone {
    /// 1 − cos of the half-angle, as sin² / (1 + cos), which keeps digits for small angles.
    #[inline(always)]
    fn height(&self) -> f64 {
        self.sine * self.sine * self.part
    }
}

impl Sphere {
    /// [`Solid::meets`] with one error bound for the whole formula ([`ball`]) in place of one per operation.
    ///
    /// Let u = [`UNIT`] and w the rounded vector from the center. Then d² errs by 3u of it, r² d² by 5u, w² by 5u, and
    /// w · d by 4u |w| |d|. w × d errs by 3u of the magnitudes of its products, in all by 3√2 u |w| |d|. So its square
    /// errs by 3u of it and by 8.5u |w × d| |w| |d| + 18u² w² d² more. The bounds used here are greater by more than
    /// their own roundings, and, unless r² d² is tiny, by more than any underflow.
    #[inline(always)]
    fn quickly(&self, ray: &Ray) -> Option<Meets<Bounded>> {
        const LEAST: f64 = f64::from_bits((1023 - 400) << 52);
        let (w, d) = (ray.origin - self.center, ray.direction);
        let (a, ww, rr) = (d.dot(d), w.dot(w), self.radius * self.radius);
        let (moment, level) = (w.cross(d).length_squared(), rr * a);
        let size = (ww * a).sqrt();
        let error = UNIT * (8.0 * level + 5.0 * moment + 9.0 * moment.sqrt() * size + 64.0 * UNIT * size * size);
        let discriminant = level - moment;
        if !((LEAST..1.0 / LEAST).contains(&a) && level >= LEAST && discriminant.abs() > error) {
            return None;
        }
        if discriminant < 0.0 {
            return Some(Meets::new(true));
        }
        let root = discriminant.sqrt();
        let root_error = error / root + 2.0 * UNIT * root;
        let (b, c) = (w.dot(d), ww - rr);
        let q = root + b.abs();
        let q_error = root_error + 5.0 * UNIT * size + 2.0 * UNIT * q;
        // The root farther from the line's origin and the nearer one, both as if the line went toward the center.
        let (outer, inner) = (q / a, c / q);
        let outer_error = q_error / a * (1.0 + 8.0 * UNIT) + 6.0 * UNIT * outer;
        let inner_error = (6.0 * UNIT * (ww + rr) + inner.abs() * q_error) / (q - q_error) + 3.0 * UNIT * inner.abs();
        let meet = |t: f64, error: f64, slope: f64| {
            let slope = Bounded { value: slope, error: 2.0 * root_error };
            let bend = Bounded { value: a, error: 4.0 * UNIT * a };
            Meet { t: Bounded { value: t, error }, slope, bend, surface: 0, part: 0, contact: Contact::Inside }
        };
        let (first, second) = if b < 0.0 {
            ((inner, inner_error), (outer, outer_error))
        } else {
            ((-outer, outer_error), (-inner, inner_error))
        };
        let rise = 2.0 * root;
        let all = [Some(meet(first.0, first.1, -rise)), Some(meet(second.0, second.1, rise)), None, None];
        Some(Meets { all, count: 2, closed: true })
    }
}

/// The unit vector of a longitude and a latitude, and its derivatives.
pub(super) fn globe([u, v]: [f64; 2]) -> (DVec3, [DVec3; 2]) {
    let ((sin, cos), (out, down)) = ((TAU * u).sin_cos(), (PI * v).sin_cos());
    let direction = DVec3::new(out * cos, out * sin, -down);
    (direction, [DVec3::new(-out * sin, out * cos, 0.0) * TAU, DVec3::new(down * cos, down * sin, out) * PI])
}

/// The longitude and the latitude of a vector of any length.
pub(super) fn longitude_latitude(x: DVec3) -> [f64; 2] {
    let turn = upper_angle(x.y.abs(), x.x) / TAU;
    let square = x.x * x.x + x.y * x.y;
    // Squares rarely overflow or underflow.
    let across = if (1e-280..1e280).contains(&square) { square.sqrt() } else { x.x.hypot(x.y) };
    [if x.y < 0.0 { 1.0 - turn } else { turn }, upper_angle(across, -x.z) / PI]
}

impl Solid for Sphere {
    fn meets<N: Number>(&self, line: &Line<N>) -> Option<Meets<N>> {
        ball(&line.from(self.center), &N::of(self.radius).times(&line.unit))
    }

    #[inline(always)]
    fn meets_roughly(&self, ray: &Carried<'_>) -> Option<Meets<Bounded>> {
        match ray {
            Carried::Ray(ray) => self.quickly(ray),
            Carried::Into(..) => self.meets(&ray.line()),
        }
    }

    #[inline(always)]
    fn surface<N: Number>(&self, _: usize, point: &Triple<N>, unit: &N) -> N {
        ball_surface(point, &N::of(self.radius).times(unit))
    }

    fn coordinates(&self, _: usize, point: DVec3) -> [f64; 2] {
        longitude_latitude(point)
    }

    fn reference(&self) -> DVec3 {
        self.center
    }
}

impl Shape for Sphere {
    fn closest(&self, place: DVec3) -> Option<Closest> {
        let unit = of_ellipsoid(DVec3::splat(self.radius), place - self.center);
        Some(Closest { position: self.center + unit * self.radius, uv: longitude_latitude(unit) })
    }

    fn closest_under(&self, to_world: &Affine, to_object: &Affine, place: DVec3) -> Option<Closest> {
        let axes = DVec3::splat(self.radius);
        let (position, unit) = of_ellipsoid_under([to_world, to_object], [self.center, axes], place);
        Some(Closest { position, uv: longitude_latitude(unit) })
    }

    fn bounds(&self) -> Bounds {
        // One rounding each.
        Bounds {
            min: (self.center - self.radius).to_array().map(f64::next_down).into(),
            max: (self.center + self.radius).to_array().map(f64::next_up).into(),
        }
    }

    fn around(&self) -> Ball {
        Ball { center: self.center, radius: self.radius.next_up() }
    }

    fn support(&self, d: DVec3) -> f64 {
        let size = (d.abs() * self.center.abs()).element_sum();
        let reach = self.radius * d.length();
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

    fn site(&self, _: &Ray, _: f64, [u, v]: [f64; 2]) -> Site {
        let ([sin, cos], [out, down]) = (sin_cos_turn(u), sin_cos_turn(0.5 * v));
        let direction = DVec3::new(out * cos, out * sin, -down);
        // As in `sight_in`.
        self.towards(direction * (1.5 - 0.5 * direction.length_squared()))
    }

    fn area(&self) -> f64 {
        4.0 * PI * self.radius * self.radius
    }

    fn area_under(&self, map: &Affine) -> f64 {
        ellipsoid_area_under(map, DVec3::splat(self.radius))
    }

    fn sample(&self, u: [f64; 2]) -> Option<Drawn> {
        let direction = uniform_sphere(u);
        let uv = longitude_latitude(direction);
        Some(Drawn { point: self.at(uv), pdf: 1.0 / self.area() })
    }

    /// Uniform in the cone that the sphere subtends, or in all directions from inside.
    ///
    /// From outside, the point is computed from the angle at the center without a difference of large numbers (Pharr,
    /// Jakob, Humphreys, "Physically Based Rendering", 4th edition, 2023, section 6.2.4). The sphere may be arbitrarily
    /// small or distant.
    fn sight_from(&self, place: DVec3, u: [f64; 2]) -> Option<Seen> {
        let Some(cone) = self.cone(place) else {
            let direction = uniform_sphere(u);
            let ray = Ray { t_min: f64::MIN_POSITIVE, ..Ray::new(place, direction) };
            let mut point = None;
            self.meet(&ray, &mut |met| {
                let here = self.at(met.uv).site();
                // Reject the reference point itself, which rounding may have moved off the sphere.
                let seen = met.t > 4.0 * here.error;
                point = seen.then_some(here);
                seen
            });
            return Some(Seen { site: point?, pdf: UNIFORM_SPHERE_PDF });
        };
        Some(self.sight_in(&cone, u))
    }

    fn sample_from(&self, place: DVec3, u: [f64; 2]) -> Option<Drawn> {
        let Seen { site, pdf } = self.sight_from(place, u)?;
        Some(Drawn { point: self.at(longitude_latitude(site.normal)), pdf })
    }

    fn pdf_from(&self, place: DVec3, direction: DVec3) -> f64 {
        let is_met = self.cone(place).is_none() || self.meet(&Ray::new(place, direction), &mut |_| true);
        if is_met { self.pdf_of_met(place, direction) } else { 0.0 }
    }

    fn ball(&self) -> Option<(DVec3, f64)> {
        Some((self.center, self.radius))
    }

    fn pdf_of_met(&self, place: DVec3, _: DVec3) -> f64 {
        self.cone(place).map_or(UNIFORM_SPHERE_PDF, |cone| 1.0 / (TAU * cone.height()))
    }
}

/// The area of an ellipsoid of given semi-axes under an affine map, to a relative error of about 10⁻¹⁴.
///
/// The image is that of the unit sphere under L diag(a). The singular values of that map's cofactor matrix are the
/// pairwise products of the image's semi-axes.
pub(super) fn ellipsoid_area_under(map: &Affine, axes: DVec3) -> f64 {
    let [x, y, z] = axes.to_array();
    let columns = [DVec3::X * (y * z), DVec3::Y * (z * x), DVec3::Z * (x * y)].map(|c| map.cofactors(c));
    ellipsoid_area(at_right_angles(columns).map(DVec3::length))
}
