//! The interface of every shape other than a triangle: bounds, intersection, area and sampling.

use super::{Candidate, Carried, Closest, Flat};
use raywright_base::math::robust::UNIT;
use raywright_base::math::{Affine, DVec3, Ray};
use std::fmt::Debug;

/// An axis-aligned bounding box in f64. Unbounded shapes have infinite extents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The least corner.
    pub min: DVec3,
    /// The greatest corner.
    pub max: DVec3,
}

/// A bounding sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its center.
    pub center: DVec3,
    /// Its radius, rounded up.
    pub radius: f64,
}

impl Bounds {
    /// Return a bounding sphere of the box, provided that the box is finite.
    pub fn around(&self) -> Ball {
        // Halves do not overflow. Three roundings and a root err by far less than the padding.
        let (center, half) = (0.5 * self.min + 0.5 * self.max, 0.5 * self.max - 0.5 * self.min);
        let size = half.length() + self.min.abs().max(self.max.abs()).length() * UNIT;
        Ball { center, radius: size * (1.0 + 16.0 * UNIT) }
    }

    /// Return whether the box is finite along every axis.
    pub fn is_finite(&self) -> bool {
        self.min.is_finite() && self.max.is_finite()
    }

    /// The box of a shape with a given support function: the greatest `d · x` over its points, rounded up.
    pub fn of_support(support: impl Fn(DVec3) -> f64) -> Self {
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z];
        Self {
            min: DVec3::new(-support(-x), -support(-y), -support(-z)),
            max: DVec3::new(support(x), support(y), support(z)),
        }
    }

    /// The support function: the greatest `d · x` over the points of the box, rounded up.
    pub fn support(&self, d: DVec3) -> f64 {
        let (mut sum, mut size) = (0.0, 0.0);
        for i in 0..3 {
            let far = if d[i] > 0.0 { self.max[i] } else { self.min[i] };
            // Skip axes without a component of the direction: 0 · ∞ is NaN.
            if d[i] != 0.0 {
                sum += d[i] * far;
                size += (d[i] * far).abs();
            }
        }
        if size.is_finite() { sum + 4.0 * UNIT * size } else { sum }
    }
}

/// A position and a unit normal on a shape, sufficient for light sampling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// The point, to within `error` in each coordinate.
    pub position: DVec3,
    /// Bound on the error of each coordinate of `position`.
    pub error: f64,
    /// The unit normal; of a closed shape it points outward.
    pub normal: DVec3,
}

/// A surface point with its parametrization and the derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// The position, to within `error` in each coordinate.
    pub position: DVec3,
    /// Bound on the error of each coordinate of `position`.
    pub error: f64,
    /// The unit normal; of a closed shape it points outward.
    pub normal: DVec3,
    /// Surface parameters, each in [0, 1].
    pub uv: [f64; 2],
    /// Derivatives of the position with respect to u and v.
    pub dp: [DVec3; 2],
    /// Derivatives of the unit normal with respect to u and v.
    pub dn: [DVec3; 2],
}

impl Point {
    /// The position and normal alone.
    #[inline]
    pub fn site(&self) -> Site {
        let Self { position, error, normal, .. } = *self;
        Site { position, error, normal }
    }
}

/// A point sampled on a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drawn {
    /// The point.
    pub point: Point,
    /// Its density, by area or by solid angle from the reference point.
    pub pdf: f64,
}

/// A point on a shape sampled by solid angle from a reference point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// The point.
    pub site: Site,
    /// The density of its direction by solid angle.
    pub pdf: f64,
}

/// A geometric shape other than a triangle. All quantities are in object space.
pub trait Shape: Debug + Send + Sync {
    /// The axis-aligned bounding box, rounded outward.
    fn bounds(&self) -> Bounds;

    /// A bounding sphere; infinite for unbounded shapes.
    fn around(&self) -> Ball {
        self.bounds().around()
    }

    /// The support function: the greatest `d · x` over the shape or a box around it, rounded up. Bounds in other spaces
    /// are computed from it.
    fn support(&self, d: DVec3) -> f64 {
        self.bounds().support(d)
    }

    /// Call `met` with each intersection in `[t_min, t_max]` by increasing `t` until it returns true. Return whether it
    /// did.
    ///
    /// The direction need not be a unit vector; `t` is in multiples of its length. `t` is within two f64 of the exact
    /// value, and this rounded value is compared with the interval's ends. The decision whether there is a hit is exact
    /// for the given numbers. A line crosses a closed shape an even number of times; a tangent line is reported once,
    /// as [`super::Contact::Touching`]. A surface that contains the line is edge-on and gives no hit. A ray with a zero
    /// direction or non-finite numbers hits nothing.
    fn meet(&self, ray: &Ray, met: &mut dyn FnMut(Candidate) -> bool) -> bool;

    /// Intersect a ray of another space. Shapes decide exactly for the given ray and maps where they can; others
    /// intersect the ray rounded to f64 in object space.
    fn meet_carried(&self, ray: &Carried<'_>, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
        self.meet(&ray.rounded(), met)
    }

    /// The surface point of a candidate that [`Shape::meet`] reported for this ray, projected onto the surface to f64
    /// precision.
    fn point(&self, ray: &Ray, t: f64, uv: [f64; 2]) -> Point;

    /// The position and normal of a candidate. Shapes may override this with a faster method within the error bounds of
    /// both.
    #[inline]
    fn site(&self, ray: &Ray, t: f64, uv: [f64; 2]) -> Site {
        self.point(ray, t, uv).site()
    }

    /// The area; infinite for unbounded shapes.
    fn area(&self) -> f64;

    /// The area under an affine map, to a relative error of about 10⁻⁹ for shapes that override this method.
    ///
    /// The default is exact for maps that scale uniformly. For other maps it averages the area stretch over a regular
    /// grid of samples. The grid is refined until two successive means agree to 10⁻⁶, or has 1024² samples.
    fn area_under(&self, map: &Affine) -> f64 {
        let area = self.area();
        if !area.is_finite() {
            return area;
        }
        if let Some(scale) = map.uniform_scale() {
            return area * scale * scale;
        }
        let mean = |side: u32| {
            let cell = |i: u32| (f64::from(i) + 0.5) / f64::from(side);
            let stretched = |i: u32| -> f64 {
                let points = (0..side).filter_map(|j| self.sample([cell(i), cell(j)]));
                points.map(|drawn| map.cofactors(drawn.point.normal).length() / drawn.pdf).sum()
            };
            (0..side).map(stretched).sum::<f64>() / f64::from(side).powi(2)
        };
        let (mut side, mut last) = (32, mean(16));
        loop {
            let next = mean(side);
            if (next - last).abs() <= 1e-6 * next || side >= 1024 {
                return next;
            }
            (side, last) = (2 * side, next);
        }
    }

    /// The unit normal, if it is constant over the shape.
    fn facing(&self) -> Option<DVec3> {
        None
    }

    /// The planar parts of the surface.
    fn flats(&self) -> Vec<Flat> {
        Vec::new()
    }

    /// Return whether the shape is closed, that is, has no boundary edge.
    fn is_closed(&self) -> bool {
        true
    }

    /// Sample a point by area from two numbers in [0, 1). `pdf` is the density by area, 1 / area for uniform sampling.
    /// None for shapes of zero or infinite area.
    fn sample(&self, u: [f64; 2]) -> Option<Drawn>;

    /// Sample a direction by solid angle and return its first intersection, with the density of [`Shape::pdf_from`].
    /// None if that direction misses.
    ///
    /// The default directs the ray toward a point sampled by area. Occlusion of that point by the shape itself is
    /// harmless: the density is that of the direction and sums over all its intersections.
    fn sample_from(&self, place: DVec3, u: [f64; 2]) -> Option<Drawn> {
        let way = self.sample(u)?.point.position - place;
        let ray = Ray { t_min: f64::MIN_POSITIVE, ..Ray::new(place, way) };
        let mut first = None;
        self.meet(&ray, &mut |met| {
            let point = self.point(&ray, met.t, met.uv);
            // Reject the reference point itself, which rounding may have moved off the surface.
            let seen = met.t * way.length() > 4.0 * point.error;
            first = seen.then_some(point);
            seen
        });
        let (point, pdf) = (first?, self.pdf_from(place, way));
        (pdf.is_finite() && pdf > 0.0).then_some(Drawn { point, pdf })
    }

    /// Sample a point without surface parameters. Shapes may override this with a faster method.
    fn sight_from(&self, place: DVec3, u: [f64; 2]) -> Option<Seen> {
        let Drawn { point, pdf } = self.sample_from(place, u)?;
        Some(Seen { site: point.site(), pdf })
    }

    /// Center and radius, if the shape is a sphere.
    fn ball(&self) -> Option<(DVec3, f64)> {
        None
    }

    /// [`Shape::pdf_from`] of a direction known to intersect the shape.
    fn pdf_of_met(&self, place: DVec3, direction: DVec3) -> f64 {
        self.pdf_from(place, direction)
    }

    /// A point of the shape closest to `place`; None if the shape does not support the query.
    fn closest(&self, _place: DVec3) -> Option<Closest> {
        None
    }

    /// A point closest to `place` on the image of the shape under a map, given with its inverse.
    ///
    /// The default maps the closest point in object space, which is correct if the map scales uniformly.
    fn closest_under(&self, to_world: &Affine, to_object: &Affine, place: DVec3) -> Option<Closest> {
        if to_world.uniform_scale().is_none() {
            return self.closest_stretched(to_world, to_object, place);
        }
        let own = self.closest(to_object.point(place))?;
        Some(Closest { position: to_world.point(own.position), ..own })
    }

    /// The closest point under a map that does not scale uniformly and so may change which point is closest.
    fn closest_stretched(&self, _to_world: &Affine, _to_object: &Affine, _place: DVec3) -> Option<Closest> {
        None
    }

    /// The solid angle density with which [`Shape::sample_from`] samples a direction of any length; 0 outside its
    /// support.
    ///
    /// The default sums over all intersections along the direction, assuming that [`Shape::sample`] is uniform.
    fn pdf_from(&self, place: DVec3, direction: DVec3) -> f64 {
        let area = self.area();
        if !area.is_finite() {
            return 0.0;
        }
        let ray = Ray { t_min: f64::MIN_POSITIVE, ..Ray::new(place, direction) };
        let length = direction.length();
        let mut pdf = 0.0;
        self.meet(&ray, &mut |met| {
            let cosine = self.point(&ray, met.t, met.uv).normal.dot(direction).abs() / length;
            let distance = met.t * length;
            if cosine > 0.0 {
                pdf += distance * distance / (cosine * area);
            }
            false
        });
        pdf
    }
}
