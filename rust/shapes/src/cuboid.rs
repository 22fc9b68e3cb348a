//! The axis-aligned box.

use super::line::Line;
use super::meeting::tell;
use super::solid::{Meet, Meets, Solid};
use super::triangle::{nearest_point, point_of};
use super::{Bounds, Candidate, Carried, Closest, Contact, Drawn, Flat, Point, Shape};
use raywright_base::math::robust::UNIT;
use raywright_base::math::{Affine, Bounded, DVec3, Number, Ray, Triple};
use std::cmp::Ordering;

/// The solid box between two corners, borders included. A line in a face or along an edge hits it.
///
/// The parametrization lays the six faces side by side: three columns for the axes x, y and z, two rows for the min and
/// the max side. Within its cell a face is spanned by the two other axes in cyclic order: y and z for x, z and x for y,
/// x and y for z. The first of them is reversed in the lower row, so that all faces appear as seen from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Cuboid {
    /// The min corner.
    pub min: DVec3,
    /// The max corner, nowhere less than `min`.
    pub max: DVec3,
}

/// Two triangles per face. Corners are numbered x + 2 y + 4 z and ordered anticlockwise as seen from outside.
const FACES: [[usize; 3]; 12] = [
    [0, 2, 1],
    [1, 2, 3],
    [4, 5, 6],
    [5, 7, 6],
    [0, 1, 4],
    [1, 5, 4],
    [2, 6, 3],
    [3, 6, 7],
    [0, 4, 2],
    [2, 4, 6],
    [1, 3, 5],
    [3, 7, 5],
];

/// Inset within a cell, so that rounding cannot leave the cell.
const WITHIN: f64 = 1.0 / (1u64 << 50) as f64;

impl Cuboid {
    /// The areas of the faces normal to x, y and z.
    fn areas(&self) -> [f64; 3] {
        let e = self.max - self.min;
        [e.y * e.z, e.z * e.x, e.x * e.y]
    }

    /// The point at given surface parameters.
    ///
    /// It lies exactly in its face; along the face, a product and a sum err by two UNIT.
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
            // From the nearer end, so that both ends are exact.
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

    /// The surface parameters of a point of a face, given as fractions along its two axes.
    fn cell(axis: usize, greater: bool, [a, b]: [f64; 2]) -> [f64; 2] {
        let a = if greater { a } else { 1.0 - a };
        let within = |x: f64| x.clamp(0.0, 1.0) * (1.0 - 2.0 * WITHIN) + WITHIN;
        [(axis as f64 + within(a)) / 3.0, (f64::from(u8::from(greater)) + within(b)) / 2.0]
    }
}

impl Cuboid {
    /// [`Solid::meets`] in f64, if no two relevant faces are hit at nearly the same `t`.
    ///
    /// A difference and a quotient err by one UNIT each. The quotient errs negligibly more where it is subnormal.
    #[inline(always)]
    fn quickly(&self, ray: &Ray) -> Option<Meets<Bounded>> {
        let (o, d) = (ray.origin, ray.direction);
        let (mut near, mut far) = ([f64::NEG_INFINITY; 2], [f64::INFINITY; 2]);
        let (mut first, mut last) = (0, 0);
        for axis in 0..3 {
            if d[axis] == 0.0 {
                if o[axis] < self.min[axis] || o[axis] > self.max[axis] {
                    return Some(Meets::new(true));
                }
                continue;
            }
            let (below, above) = ((self.min[axis] - o[axis]) / d[axis], (self.max[axis] - o[axis]) / d[axis]);
            let up = d[axis] > 0.0;
            let (enter, leave) = if up { (below, above) } else { (above, below) };
            if enter > near[0] {
                (near, first) = ([enter, near[0]], 2 * axis + usize::from(!up));
            } else {
                near[1] = near[1].max(enter);
            }
            if leave < far[0] {
                (far, last) = ([leave, far[0]], 2 * axis + usize::from(up));
            } else {
                far[1] = far[1].min(leave);
            }
        }
        let error = |t: f64| 3.0 * UNIT * t.abs() + f64::MIN_POSITIVE;
        // On a miss there is only one face to compare with, and it is at infinity.
        let apart = |less: f64, more: f64| less.is_infinite() || more - less > 2.0 * (error(less) + error(more));
        if near[0].abs().max(far[0].abs()) > 1e300 {
            return None;
        }
        if apart(far[0], near[0]) {
            return Some(Meets::new(true));
        }
        let certain =
            apart(near[0], far[0]) && apart(near[1], near[0]) && (far[1].is_infinite() || apart(far[0], far[1]));
        if !certain {
            return None;
        }
        let meet = |t: f64, part: usize| {
            let (t, slope) = (Bounded { value: t, error: error(t) }, Bounded::of(d[part / 2]));
            Meet { t, slope, bend: Bounded::of(0.0), surface: part, part, contact: Contact::Inside }
        };
        Some(Meets::new(true).with(meet(near[0], first)).with(meet(far[0], last)))
    }
}

/// p / q with q > 0: the line parameter at a face.
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
    /// The last face entered and the first face left (Kay and Kajiya 1986), compared as fractions.
    fn meets<N: Number>(&self, line: &Line<N>) -> Option<Meets<N>> {
        let mut near: Option<Crossing<N>> = None;
        let mut far: Option<Crossing<N>> = None;
        for axis in 0..3 {
            let (o, d) = (&line.origin.0[axis], &line.direction.0[axis]);
            let [below, above] = [self.min[axis], self.max[axis]].map(|x| N::of(x).times(&line.unit).minus(o));
            let (first, last, q) = match d.sign()? {
                Ordering::Equal => {
                    if below.sign()? == Ordering::Greater || above.sign()? == Ordering::Less {
                        return Some(Meets::new(true));
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
        let (Some(near), Some(far)) = (near, far) else { return Some(Meets::new(true)) };
        let order = near.compare(&far)?;
        if order == Ordering::Greater {
            return Some(Meets::new(true));
        }
        let meet = |Crossing { p, q, part }: Crossing<N>| {
            let slope = line.direction.0[part / 2].clone();
            Meet { t: p.over(&q), slope, bend: N::of(0.0), surface: part, part, contact: Contact::Inside }
        };
        let first = Meets::new(true).with(meet(near));
        Some(if order == Ordering::Equal { first } else { first.with(meet(far)) })
    }

    #[inline(always)]
    fn meets_roughly(&self, ray: &Carried<'_>) -> Option<Meets<Bounded>> {
        match ray {
            Carried::Ray(ray) => self.quickly(ray),
            Carried::Into(..) => self.meets(&ray.line()),
        }
    }

    #[inline(always)]
    fn surface<N: Number>(&self, surface: usize, point: &Triple<N>, unit: &N) -> N {
        let (axis, greater) = (surface / 2, surface % 2 == 1);
        let from_lesser = &point.0[axis];
        if !greater {
            return from_lesser.clone();
        }
        from_lesser.minus(&N::of(self.max[axis]).minus(&N::of(self.min[axis])).times(unit))
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
    fn flats(&self) -> Vec<Flat> {
        let pick = |number: usize, axis: usize| (if number >> axis & 1 == 0 { self.min } else { self.max })[axis];
        let corner = |number: usize| DVec3::new(pick(number, 0), pick(number, 1), pick(number, 2));
        FACES.iter().map(|face| Flat::Triangle(face.map(corner))).collect()
    }

    fn closest(&self, place: DVec3) -> Option<Closest> {
        let (below, above) = (self.min - place, place - self.max);
        // The distance beyond each face. Inside the box all are 0 or less, and the greatest belongs to the closest
        // face.
        let beyond = [below.x, above.x, below.y, above.y, below.z, above.z];
        let part = (1..6).fold(0, |most, part| if beyond[part] > beyond[most] { part } else { most });
        let mut position = place.clamp(self.min, self.max);
        let (axis, greater) = (part / 2, part % 2 == 1);
        position[axis] = if greater { self.max[axis] } else { self.min[axis] };
        Some(Closest { position, uv: self.coordinates(part, position - self.min) })
    }

    /// The minimum over the image's six faces, two triangles each.
    fn closest_under(&self, to_world: &Affine, _: &Affine, place: DVec3) -> Option<Closest> {
        let mut best: Option<(f64, Closest)> = None;
        for part in 0..6 {
            let axis = part / 2;
            let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
            let corner = |far: [bool; 2]| {
                let mut at = if part % 2 == 1 { self.max } else { self.min };
                at[i] = if far[0] { self.max[i] } else { self.min[i] };
                at[j] = if far[1] { self.max[j] } else { self.min[j] };
                at
            };
            let (from, to) = (corner([false, false]), corner([true, true]));
            for middle in [corner([true, false]), corner([false, true])] {
                let own = [from, middle, to];
                let image = own.map(|at| to_world.point(at));
                let found = nearest_point(image, place);
                if best.is_none_or(|(distance, _)| found.distance < distance) {
                    let uv = self.coordinates(part, point_of(own, found.uv) - self.min);
                    best = Some((found.distance, Closest { position: point_of(image, found.uv), uv }));
                }
            }
        }
        best.map(|(_, closest)| closest)
    }

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
        // The first number chooses the face; its remainder is uniform again.
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
