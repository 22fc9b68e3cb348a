//! The box along the axes.

use super::line::Line;
use super::meeting::{Meets, Solid, ends, tell};
use super::{Bounds, Candidate, Carried, Drawn, Point, Shape};
use crate::math::robust::UNIT;
use crate::math::{Affine, DVec3, Number, Ray};
use std::cmp::Ordering;

/// All points between two corners, borders included: a solid, so that a line in a face, or along an edge, meets it.
///
/// Its coordinates lay the six faces side by side: three columns for those at right angles to x, y and z, two rows for the lesser
/// and the greater. In its cell a face runs along the two other axes in turn (y and z of x, z and x of y, x and y of z), the first of
/// them reversed in the lower row, so that all are seen from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Cuboid {
    /// The least corner.
    pub min: DVec3,
    /// The greatest corner, nowhere less.
    pub max: DVec3,
}

/// Within a cell, so that rounding leads into no other.
const WITHIN: f64 = 1.0 / (1u64 << 50) as f64;

impl Cuboid {
    /// The areas of a face at right angles to x, to y and to z.
    fn areas(&self) -> [f64; 3] {
        let e = self.max - self.min;
        [e.y * e.z, e.z * e.x, e.x * e.y]
    }

    /// The point of given coordinates.
    ///
    /// It lies in its face exactly. Along it: a product and a sum of two UNIT.
    fn at(&self, uv: [f64; 2]) -> Point {
        let column = (uv[0] * 3.0).floor().clamp(0.0, 2.0);
        let greater = uv[1] >= 0.5;
        let axis = column as usize;
        let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
        let (a, b) = (uv[0] * 3.0 - column, uv[1] * 2.0 - f64::from(u8::from(greater)));
        let (a, sense) = if greater { (a, 1.0) } else { (1.0 - a, -1.0) };
        let extent = self.max - self.min;
        let mut position = if greater { self.max } else { self.min };
        let between = |i: usize, share: f64| {
            // From the nearer end, so that both are met.
            let x =
                if share <= 0.5 { self.min[i] + extent[i] * share } else { self.max[i] - extent[i] * (1.0 - share) };
            x.clamp(self.min[i], self.max[i])
        };
        (position[j], position[k]) = (between(j, a), between(k, b));
        let unit = |i: usize, by: f64| {
            let mut v = DVec3::ZERO;
            v[i] = by;
            v
        };
        Point {
            position,
            error: UNIT * (position.abs().max_element() + 2.0 * extent.max_element()),
            normal: unit(axis, sense),
            uv,
            dp: [unit(j, 3.0 * sense * extent[j]), unit(k, 2.0 * extent[k])],
            dn: [DVec3::ZERO; 2],
        }
    }

    /// The coordinates of a face's point, by its share along the face's two axes.
    fn cell(axis: usize, greater: bool, [a, b]: [f64; 2]) -> [f64; 2] {
        let a = if greater { a } else { 1.0 - a };
        let within = |x: f64| x.clamp(0.0, 1.0) * (1.0 - 2.0 * WITHIN) + WITHIN;
        [(axis as f64 + within(a)) / 3.0, (f64::from(u8::from(greater)) + within(b)) / 2.0]
    }
}

/// p / q with q above 0: where a line meets a face.
struct Crossing<N> {
    p: N,
    q: N,
    part: usize,
}

impl<N: Number> Crossing<N> {
    fn compare(&self, other: &Self) -> Option<Ordering> {
        self.p.times(&other.q).minus(&other.p.times(&self.q)).sign()
    }
}

impl Solid for Cuboid {
    /// The last face that the line comes in by, and the first that it goes out by (Kay and Kajiya 1986), compared as fractions.
    fn meets<N: Number>(&self, line: &Line<N>) -> Option<Meets> {
        let mut near: Option<Crossing<N>> = None;
        let mut far: Option<Crossing<N>> = None;
        for axis in 0..3 {
            let (o, d) = (&line.origin.0[axis], &line.direction.0[axis]);
            let [below, above] = [self.min[axis], self.max[axis]].map(|x| N::of(x).times(&line.unit).minus(o));
            let (first, last, q) = match d.sign()? {
                Ordering::Equal => {
                    if below.sign()? == Ordering::Greater || above.sign()? == Ordering::Less {
                        return Some(Meets::default());
                    }
                    continue;
                }
                Ordering::Greater => ((below, 2 * axis), (above, 2 * axis + 1), d.clone()),
                Ordering::Less => ((above.negated(), 2 * axis + 1), (below.negated(), 2 * axis), d.negated()),
            };
            let crossing = |(p, part)| Crossing { p, q: q.clone(), part };
            let (first, last) = (crossing(first), crossing(last));
            near = Some(match near {
                Some(near) if near.compare(&first)? != Ordering::Less => near,
                _ => first,
            });
            far = Some(match far {
                Some(far) if far.compare(&last)? != Ordering::Greater => far,
                _ => last,
            });
        }
        let (Some(near), Some(far)) = (near, far) else { return Some(Meets::default()) };
        let order = near.compare(&far)?;
        if order == Ordering::Greater {
            return Some(Meets::default());
        }
        let value = |c: &Crossing<N>| c.p.over(&c.q).rounded();
        let near_t = value(&near)?;
        let far_t = if order == Ordering::Equal { near_t } else { value(&far)? };
        Some(ends((near_t, near.part), (far_t, far.part)))
    }

    fn coordinates(&self, part: usize, point: DVec3) -> [f64; 2] {
        let (axis, greater) = (part / 2, part % 2 == 1);
        let extent = self.max - self.min;
        let share = |i: usize| if extent[i] > 0.0 { point[i] / extent[i] } else { 0.5 };
        Self::cell(axis, greater, [share((axis + 1) % 3), share((axis + 2) % 3)])
    }

    fn reference(&self) -> DVec3 {
        self.min
    }
}

impl Shape for Cuboid {
    fn bounds(&self) -> Bounds {
        Bounds { min: self.min, max: self.max }
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
        2.0 * self.areas().iter().sum::<f64>()
    }

    fn area_under(&self, map: &Affine) -> f64 {
        let [x, y, z] = self.areas();
        let stretched = [DVec3::X * x, DVec3::Y * y, DVec3::Z * z].map(|face| map.cofactors(face).length());
        2.0 * stretched.iter().sum::<f64>()
    }

    fn sample(&self, u: [f64; 2]) -> Option<Drawn> {
        let areas = self.areas();
        let half: f64 = areas.iter().sum();
        // The first number chooses the face, and what is left of it is as even as it was.
        let greater = u[0] >= 0.5;
        let mut left = (2.0 * u[0] - f64::from(u8::from(greater))) * half;
        let mut axis = 0;
        while axis < 2 && left >= areas[axis] {
            left -= areas[axis];
            axis += 1;
        }
        if areas[axis] <= 0.0 {
            axis = (0..3).find(|&i| areas[i] > 0.0)?;
            left = 0.5 * areas[axis];
        }
        let uv = Self::cell(axis, greater, [left / areas[axis], u[1]]);
        Some(Drawn { point: self.at(uv), pdf: 0.5 / half })
    }
}
