//! What every shape that is no triangle can be asked.

use super::{Candidate, Carried, Closest, Flat};
use raywright_base::math::robust::UNIT;
use raywright_base::math::{Affine, DVec3, Ray};
use std::fmt::Debug;

/// The closed box from one corner to another, in f64. Infinite along an axis where what it holds is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The least corner.
    pub min: DVec3,
    /// The greatest corner.
    pub max: DVec3,
}

/// A ball that holds a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its middle.
    pub center: DVec3,
    /// Its radius, rounded up.
    pub radius: f64,
}

impl Bounds {
    /// A ball around the box, if that ends on every side.
    pub fn around(&self) -> Ball {
        // Halves do not overflow; three roundings and a root are far below what is added.
        let (center, half) = (0.5 * self.min + 0.5 * self.max, 0.5 * self.max - 0.5 * self.min);
        let size = half.length() + self.min.abs().max(self.max.abs()).length() * UNIT;
        Ball { center, radius: size * (1.0 + 16.0 * UNIT) }
    }

    /// Whether it ends on every side.
    pub fn is_finite(&self) -> bool {
        self.min.is_finite() && self.max.is_finite()
    }

    /// The box of a shape by its support: the greatest `d · x` of its points for each direction asked, rounded up.
    pub fn of_support(support: impl Fn(DVec3) -> f64) -> Self {
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z];
        Self {
            min: DVec3::new(-support(-x), -support(-y), -support(-z)),
            max: DVec3::new(support(x), support(y), support(z)),
        }
    }

    /// The greatest `d · x` of its points, rounded up.
    pub fn support(&self, d: DVec3) -> f64 {
        let (mut sum, mut size) = (0.0, 0.0);
        for i in 0..3 {
            let far = if d[i] > 0.0 { self.max[i] } else { self.min[i] };
            // An axis along which it has no end does not count where the direction has no part along it.
            if d[i] != 0.0 {
                sum += d[i] * far;
                size += (d[i] * far).abs();
            }
        }
        if size.is_finite() { sum + 4.0 * UNIT * size } else { sum }
    }
}

/// Where a point of a shape is and where the surface faces: all that light needs to know of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// The point, to within `error` in each coordinate.
    pub position: DVec3,
    /// Bound on the error of each coordinate of `position`.
    pub error: f64,
    /// The unit normal, to the outside of what is closed.
    pub normal: DVec3,
}

/// A point of a shape, and how the surface lies there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Where it is, to within `error` in each coordinate.
    pub position: DVec3,
    /// Bound on the error of each coordinate of `position`.
    pub error: f64,
    /// The unit normal, to the outside of what is closed.
    pub normal: DVec3,
    /// Coordinates on the shape, each from 0 to 1.
    pub uv: [f64; 2],
    /// How the position changes with either coordinate.
    pub dp: [DVec3; 2],
    /// How the unit normal changes with either coordinate.
    pub dn: [DVec3; 2],
}

impl Point {
    /// The point without its coordinates.
    #[inline]
    pub fn site(&self) -> Site {
        let Self { position, error, normal, .. } = *self;
        Site { position, error, normal }
    }
}

/// A point drawn from a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drawn {
    /// The point.
    pub point: Point,
    /// Its density: by area, or by solid angle as seen from where it was drawn for.
    pub pdf: f64,
}

/// A point drawn from a shape as seen from a place, by solid angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// The point.
    pub site: Site,
    /// The density of its direction.
    pub pdf: f64,
}

/// What can be hit and is no triangle. Everything is in the shape's own space.
pub trait Shape: Debug + Send + Sync {
    /// The least box around it, rounded outwards.
    fn bounds(&self) -> Bounds;

    /// A ball around it; infinite where it is.
    fn around(&self) -> Ball {
        self.bounds().around()
    }

    /// The greatest `d · x` of its points x, or of a box around them, rounded up: what boxes in other spaces are made
    /// of.
    fn support(&self, d: DVec3) -> f64 {
        self.bounds().support(d)
    }

    /// Calls `met` with every point where the line meets the shape and `t_min ≤ t ≤ t_max`, both ends included, by
    /// increasing `t`, until it says true; says whether it did.
    ///
    /// The direction need not be unit, and `t` counts in its lengths: it is the f64 next to the exact one, or next but
    /// one, and it is what is compared with the ends. Whether there is a hit is decided for the numbers as they are
    /// given. A closed shape is crossed evenly: a line that touches it is told once, as [`super::Contact::Touching`]. A
    /// surface that the line runs along is seen edge-on and not met. A line that is not finite, or has no direction,
    /// meets nothing.
    fn meet(&self, ray: &Ray, met: &mut dyn FnMut(Candidate) -> bool) -> bool;

    /// The same for a ray of another space. Where they can, shapes decide for the ray and the maps as they are given;
    /// others take the ray rounded to f64 in their own space.
    fn meet_carried(&self, ray: &Carried<'_>, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
        self.meet(&ray.rounded(), met)
    }

    /// The point of a candidate that [`Shape::meet`] told of this ray, moved onto the surface as nearly as f64 can.
    fn point(&self, ray: &Ray, t: f64, uv: [f64; 2]) -> Point;

    /// The same without coordinates, for shapes that know a shorter way: within the errors of both.
    #[inline]
    fn site(&self, ray: &Ray, t: f64, uv: [f64; 2]) -> Site {
        self.point(ray, t, uv).site()
    }

    /// Its area; infinite where it has no end.
    fn area(&self) -> f64;

    /// The area of its image under a map; to about 10⁻⁹ of itself where a shape has a formula of its own.
    ///
    /// Here: exact where the map scales evenly. Else the mean of the stretch at points drawn evenly from a grid, of
    /// which ever finer ones are taken until the last two agree to 10⁻⁶, or the last has 1024² points.
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

    /// The unit normal that all of its points have; none where they differ.
    fn facing(&self) -> Option<DVec3> {
        None
    }

    /// The parts of its surface that are flat.
    fn flats(&self) -> Vec<Flat> {
        Vec::new()
    }

    /// Whether it encloses a part of space: what has an edge does not.
    fn is_closed(&self) -> bool {
        true
    }

    /// A point drawn by area, from two numbers in [0, 1); `pdf` is the density there, 1 / area where it is even. None
    /// for a shape without end, or of no area.
    fn sample(&self, u: [f64; 2]) -> Option<Drawn>;

    /// The first point of a direction drawn by solid angle as seen from a place, and the density of that direction,
    /// which is [`Shape::pdf_from`]'s. None where nothing is seen.
    ///
    /// Here: towards a point drawn by area. Whether that point is hidden by others does not matter, since the density
    /// is that of the direction, and counts them all.
    fn sample_from(&self, place: DVec3, u: [f64; 2]) -> Option<Drawn> {
        let way = self.sample(u)?.point.position - place;
        let ray = Ray { t_min: f64::MIN_POSITIVE, ..Ray::new(place, way) };
        let mut first = None;
        self.meet(&ray, &mut |met| {
            let point = self.point(&ray, met.t, met.uv);
            // A place on the shape is not seen from itself, though rounding may have moved it off the surface.
            let seen = met.t * way.length() > 4.0 * point.error;
            first = seen.then_some(point);
            seen
        });
        let (point, pdf) = (first?, self.pdf_from(place, way));
        (pdf.is_finite() && pdf > 0.0).then_some(Drawn { point, pdf })
    }

    /// The same without the point's coordinates, for which shapes may know a shorter way.
    fn sight_from(&self, place: DVec3, u: [f64; 2]) -> Option<Seen> {
        let Drawn { point, pdf } = self.sample_from(place, u)?;
        Some(Seen { site: point.site(), pdf })
    }

    /// Centre and radius, if it is a sphere.
    fn ball(&self) -> Option<(DVec3, f64)> {
        None
    }

    /// [`Shape::pdf_from`] of a direction that is known to meet it.
    fn pdf_of_met(&self, place: DVec3, direction: DVec3) -> f64 {
        self.pdf_from(place, direction)
    }

    /// The point that is nearest to another, of several one; none where there is none.
    fn closest(&self, _place: DVec3) -> Option<Closest> {
        None
    }

    /// The same of its image under a map, of which the inverse is given too.
    ///
    /// Here: its own, where the map scales all lengths alike.
    fn closest_under(&self, to_world: &Affine, to_object: &Affine, place: DVec3) -> Option<Closest> {
        if to_world.uniform_scale().is_none() {
            return self.closest_stretched(to_world, to_object, place);
        }
        let own = self.closest(to_object.point(place))?;
        Some(Closest { position: to_world.point(own.position), ..own })
    }

    /// The same where the map scales some lengths more than others, which changes what is nearest.
    fn closest_stretched(&self, _to_world: &Affine, _to_object: &Affine, _place: DVec3) -> Option<Closest> {
        None
    }

    /// The density by solid angle with which [`Shape::sample_from`] draws a direction, of any length, from a place. 0
    /// where it draws none.
    ///
    /// Here: the sum over all points that lie there, if [`Shape::sample`] is even.
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
