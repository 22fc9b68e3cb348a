//! A ray's line in object space, in any number type.

use raywright_base::math::{Affine, DVec3, Double, Number, Ray, Triple};

/// A ray and the maps into object space, outermost first.
///
/// Nothing is rounded in between: each number type computes the line in object space by itself. Decisions there hold
/// for the given ray and matrices.
#[derive(Clone, Copy, Debug)]
pub enum Carried<'a> {
    /// The ray itself.
    Ray(&'a Ray),
    /// Into the space of a map, by its inverse.
    Into(&'a Carried<'a>, &'a Affine),
}

/// The line `(origin + t · direction) / unit`, with a unit above 0.
///
/// The inverse of a matrix is its adjugate over its determinant. Keeping the determinant as a common denominator avoids
/// division, so predicates on a line remain polynomials. Callers measure all lengths in these units.
#[derive(Clone, Debug)]
pub struct Line<N> {
    /// The origin, in units.
    pub origin: Triple<N>,
    /// The direction, in units.
    pub direction: Triple<N>,
    /// The common denominator.
    pub unit: N,
}

impl Carried<'_> {
    /// The ray before all maps.
    pub fn ray(&self) -> &Ray {
        match self {
            Self::Ray(ray) => ray,
            Self::Into(outer, _) => outer.ray(),
        }
    }

    /// Return whether all coordinates are finite and the direction is not zero.
    pub fn is_line(&self) -> bool {
        let Ray { origin, direction, .. } = self.ray();
        origin.is_finite() && direction.is_finite() && *direction != DVec3::ZERO
    }

    /// The line in the innermost space.
    #[inline(always)]
    pub fn line<N: Number>(&self) -> Line<N> {
        match self {
            Self::Ray(ray) => {
                Line { origin: Triple::of(ray.origin), direction: Triple::of(ray.direction), unit: N::of(1.0) }
            }
            Self::Into(outer, map) => outer.line_into(map),
        }
    }

    fn line_into<N: Number>(&self, map: &Affine) -> Line<N> {
        let Line { origin, direction, unit } = self.line::<N>();
        let ([x, y, z], determinant) = map.adjugate_in::<N>();
        let shifted = origin.minus(&Triple::of(map.shift).times(&unit));
        Line {
            origin: Triple([x.dot(&shifted), y.dot(&shifted), z.dot(&shifted)]),
            direction: Triple([x.dot(&direction), y.dot(&direction), z.dot(&direction)]),
            unit: unit.times(&determinant),
        }
    }

    /// The point at `t` in object space relative to `from`, in units, and the unit. A full double-double remains after
    /// cancellation, whereas [`Carried::line`] loses digits to it.
    #[inline(always)]
    pub fn at(&self, t: f64, from: DVec3) -> (Triple<Double>, Double) {
        match self {
            Self::Ray(Ray { origin, direction, .. }) => {
                let at = |i: usize| Double::difference(origin[i], from[i]).plus(&Double::product(direction[i], t));
                (Triple([at(0), at(1), at(2)]), Double::of(1.0))
            }
            Self::Into(outer, map) => outer.at_into(map, t, from),
        }
    }

    fn at_into(&self, map: &Affine, t: f64, from: DVec3) -> (Triple<Double>, Double) {
        let (point, unit) = self.at(t, map.shift);
        let ([x, y, z], determinant) = map.adjugate_in::<Double>();
        let unit = unit.times(&determinant);
        let point = Triple([x.dot(&point), y.dot(&point), z.dot(&point)]);
        (point.minus(&Triple::of(from).times(&unit)), unit)
    }

    /// The point at `t` in object space relative to `from`, rounded once.
    #[inline(always)]
    pub fn point(&self, t: f64, from: DVec3) -> DVec3 {
        let (Triple([x, y, z]), unit) = self.at(t, from);
        DVec3::new(x.over(&unit).high, y.over(&unit).high, z.over(&unit).high)
    }

    /// The ray in object space, rounded to f64 at the end; `t` is unchanged.
    pub fn rounded(&self) -> Ray {
        let ray = self.ray();
        if matches!(self, Self::Ray(_)) {
            return *ray;
        }
        let Line { origin, direction, unit } = self.line::<Double>();
        let rounded = |v: &Triple<Double>| DVec3::from_array(v.0.each_ref().map(|x| x.over(&unit).high));
        Ray { origin: rounded(&origin), direction: rounded(&direction), ..*ray }
    }
}

impl<N: Number> Line<N> {
    /// The same line relative to another origin; all lengths in units.
    #[inline]
    pub fn from(&self, origin: DVec3) -> Self {
        Self { origin: self.origin.minus(&Triple::of(origin).times(&self.unit)), ..self.clone() }
    }
}

impl Line<Double> {
    /// The point at `t`, rounded once.
    pub fn at(&self, t: f64) -> DVec3 {
        let point = self.origin.plus(&self.direction.times(&Double::of(t)));
        DVec3::from_array(point.0.each_ref().map(|x| x.over(&self.unit).high))
    }
}
