//! The disk and the annulus.

use super::closest_on_revolution::Around;
use super::line::Line;
use super::meeting::tell;
use super::plane::crossing;
use super::solid::{Meets, Solid};
use super::{Bounds, Candidate, Carried, Closest, Drawn, Flat, Point, Shape};
use raywright_base::math::robust::UNIT;
use raywright_base::math::{Affine, DVec3, Frame, Number, Ray, Triple};
use raywright_base::sampling::warp::uniform_disk;
use std::cmp::Ordering;
use std::f64::consts::{PI, TAU};

/// The points of a plane between two distances from a center, both included.
///
/// u is the angle about the normal in turns. v runs from the outer rim to the inner one, or to the center.
#[derive(Clone, Debug, PartialEq)]
pub struct Disk {
    /// Its center.
    pub center: DVec3,
    /// The normal of the outside, with any length but 0.
    pub normal: DVec3,
    /// The radius of the rim.
    pub radius: f64,
    /// The radius of the hole; 0 for a whole disk.
    pub inner_radius: f64,
}

impl Disk {
    fn frame(&self) -> Frame {
        Frame::new((self.normal / self.normal.abs().max_element()).normalize())
    }

    fn at(&self, [u, v]: [f64; 2]) -> Point {
        let Frame { tangent, bitangent, normal } = self.frame();
        let (sin, cos) = (TAU * u).sin_cos();
        let out = tangent * cos + bitangent * sin;
        let width = self.radius - self.inner_radius;
        let radius = self.inner_radius + width * (1.0 - v);
        let position = self.center + out * radius;
        // One UNIT of the position for the last sum, and the radius times a frame that is orthogonal to within 8 UNIT.
        let error = UNIT * (position.abs().max_element() + 16.0 * self.radius);
        let round = (bitangent * cos - tangent * sin) * (TAU * radius);
        Point { position, error, normal, uv: [u, v], dp: [round, out * -width], dn: [DVec3::ZERO; 2] }
    }
}

/// Solid angle sampling of a whole disk from nearby, in polar coordinates about the foot of the perpendicular from the
/// reference point.
///
/// The solid angle is dω = dφ dc, with c the cosine to the normal, so directions are uniform along the line of a fixed
/// φ. The density of φ is a free choice that the pdf accounts for. It is uniform if the foot is inside the disk, and
/// otherwise proportional to the chord length on that line. Both differ from uniform solid angle by small factors.
/// Exactly uniform sampling (Guillén et al., "Area-Preserving Parameterizations for Spherical Ellipses", 2017) inverts
/// an elliptic integral per sample.
struct EllipseProjection {
    height: f64,
    /// Distance and unit vector from the foot to the center, in the disk's frame.
    distance: f64,
    towards: [f64; 2],
    radius: f64,
}

/// The part of a line through the foot that lies on the disk.
struct Chord {
    /// The solid angle density of the directions to it.
    pdf: f64,
    /// 1 − c at its near end, c at its far end, and the difference of c.
    near: f64,
    far: f64,
    span: f64,
}

impl EllipseProjection {
    /// The chord at an angle given by its approximate cosine and sine.
    fn chord(&self, cos: f64, sin: f64) -> Chord {
        let (height, aside) = (self.height, self.distance * sin);
        let half = ((self.radius - aside) * (self.radius + aside)).max(0.0).sqrt();
        let middle = self.distance * cos;
        let end = middle + half;
        // From the foot, or from the intersection of the line with the rim.
        let inside = self.distance < self.radius;
        let start = if inside { 0.0 } else { (self.distance - self.radius) * (self.distance + self.radius) / end };
        let (r0, r1) = (start.hypot(height), end.hypot(height));
        // The span is height · (end² − start²) / lengths. The density of the angle is 1 / 2π inside, and outside 2 half
        // · middle / π radius², where end² − start² is 4 half · middle. For a chord of length 0 the quotient has its
        // limit.
        let lengths = r0 * r1 * (r0 + r1);
        let (squares, per_square) = if inside {
            (end * end, 1.0 / (TAU * end * end))
        } else {
            (4.0 * middle * half, 0.5 / (PI * self.radius.powi(2)))
        };
        Chord {
            pdf: per_square * lengths / height,
            near: start * start / (r0 * (r0 + height)),
            far: height / r1,
            span: height * squares / lengths,
        }
    }

    /// Sample a point relative to the foot in the disk's frame; return its density too.
    fn sample(&self, u: [f64; 2]) -> ([f64; 2], f64) {
        let (cos, sin, along) = if self.distance < self.radius {
            let (sin, cos) = (TAU * u[0]).sin_cos();
            (cos, sin, u[1])
        } else {
            // For a uniform point of the unit disk, x has the density of the chord length, and the position on the
            // chord is uniform.
            let point = uniform_disk(u);
            let half = ((1.0 - point.x) * (1.0 + point.x)).max(0.0).sqrt();
            let sin = self.radius * point.x / self.distance;
            let along = if half > 0.0 { (0.5 + 0.5 * point.y / half).clamp(0.0, 1.0) } else { 0.5 };
            (((1.0 - sin) * (1.0 + sin)).max(0.0).sqrt(), sin, along)
        };
        let chord = self.chord(cos, sin);
        let (down, cosine) = (chord.near + chord.span * along, chord.far + chord.span * (1.0 - along));
        let out = self.height * (down * (2.0 - down)).max(0.0).sqrt() / cosine;
        let [x, y] = self.towards;
        ([out * (x * cos - y * sin), out * (y * cos + x * sin)], chord.pdf)
    }

    /// The density of a point relative to the foot.
    fn pdf(&self, [x, y]: [f64; 2]) -> f64 {
        let out = x.hypot(y);
        let [a, b] = self.towards;
        let (cos, sin) = if out > 0.0 { ((x * a + y * b) / out, (y * a - x * b) / out) } else { (1.0, 0.0) };
        self.chord(cos, sin).pdf
    }
}

impl Disk {
    /// Distance of the center, in radii, from which sampling by area is as good.
    const DISTANT: f64 = 3.0;

    /// Set up solid angle sampling from a point in the disk's frame; None if sampling is by area.
    fn seen(&self, place: DVec3) -> Option<EllipseProjection> {
        let is_near = place.length_squared() < (Self::DISTANT * self.radius).powi(2) && self.inner_radius == 0.0;
        (is_near && place.z != 0.0).then(|| {
            let distance = place.x.hypot(place.y);
            let towards = if distance > 0.0 { [-place.x / distance, -place.y / distance] } else { [1.0, 0.0] };
            EllipseProjection { height: place.z.abs(), distance, towards, radius: self.radius }
        })
    }
}

impl Solid for Disk {
    fn meets<N: Number>(&self, line: &Line<N>) -> Option<Meets<N>> {
        let line = line.from(self.center);
        let (w, d) = (&line.origin, &line.direction);
        let normal = Triple::of(self.normal);
        // The intersection with the plane, times n · d: (n · d) w − (n · w) d = n × (w × d).
        let along = normal.dot(d);
        if along.sign()? == Ordering::Equal {
            return Some(Meets::new(false));
        }
        let there = normal.cross(&w.cross(d));
        let square = there.dot(&there);
        let against = |radius: f64| {
            let limit = N::of(radius).times(&line.unit).times(&along);
            square.minus(&limit.squared()).sign()
        };
        if against(self.radius)? == Ordering::Greater
            || (self.inner_radius > 0.0 && against(self.inner_radius)? == Ordering::Less)
        {
            return Some(Meets::new(false));
        }
        crossing(&line, &normal)
    }

    #[inline(always)]
    fn surface<N: Number>(&self, _: usize, point: &Triple<N>, _: &N) -> N {
        Triple::of(self.normal).dot(point)
    }

    fn coordinates(&self, _: usize, point: DVec3) -> [f64; 2] {
        let local = self.frame().to_local(point);
        let turn = local.y.atan2(local.x) / TAU;
        let v = (self.radius - local.x.hypot(local.y)) / (self.radius - self.inner_radius);
        [if turn < 0.0 { (turn + 1.0).min(1.0) } else { turn }, v.clamp(0.0, 1.0)]
    }

    fn reference(&self) -> DVec3 {
        self.center
    }
}

impl Shape for Disk {
    fn flats(&self) -> Vec<Flat> {
        let Frame { tangent, bitangent, .. } = self.frame();
        let axes = [tangent * self.radius, bitangent * self.radius];
        vec![Flat::Ellipse { center: self.center, axes, inner: self.inner_radius / self.radius }]
    }

    fn is_closed(&self) -> bool {
        false
    }

    fn closest(&self, place: DVec3) -> Option<Closest> {
        let frame = self.frame();
        let local = frame.to_local(place - self.center);
        let distance = local.x.hypot(local.y);
        let [x, y] = if distance > 0.0 { [local.x / distance, local.y / distance] } else { [1.0, 0.0] };
        let out = distance.clamp(self.inner_radius, self.radius);
        let from_center = (frame.tangent * x + frame.bitangent * y) * out;
        Some(Closest { position: self.center + from_center, uv: self.coordinates(0, from_center) })
    }

    fn closest_stretched(&self, to_world: &Affine, _: &Affine, place: DVec3) -> Option<Closest> {
        let frame = self.frame();
        let around = Around::new(to_world, &frame, self.center, place);
        let ends = [[self.inner_radius, 0.0], [self.radius, 0.0]];
        let from_center = frame.to_world(around.nearest(self.radius, |out| around.of_segment(out, ends)).local);
        let position = to_world.point(self.center + from_center);
        Some(Closest { position, uv: self.coordinates(0, from_center) })
    }

    fn bounds(&self) -> Bounds {
        Bounds::of_support(|d| self.support(d))
    }

    fn support(&self, d: DVec3) -> f64 {
        let normal = self.frame().normal;
        let size = (d.abs() * self.center.abs()).element_sum();
        d.dot(self.center)
            + self.radius * d.cross(normal).length()
            + UNIT * (4.0 * size + 16.0 * self.radius * d.length())
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
        PI * (self.radius - self.inner_radius) * (self.radius + self.inner_radius)
    }

    fn area_under(&self, map: &Affine) -> f64 {
        self.area() * map.cofactors(self.frame().normal).length()
    }

    fn facing(&self) -> Option<DVec3> {
        Some(self.frame().normal)
    }

    fn sample(&self, u: [f64; 2]) -> Option<Drawn> {
        // Uniform in the squared radius.
        let (inner, outer) = (self.inner_radius, self.radius);
        let radius = (inner * inner + u[1] * (outer - inner) * (outer + inner)).sqrt();
        let v = ((outer - radius) / (outer - inner)).clamp(0.0, 1.0);
        Some(Drawn { point: self.at([u[0], v]), pdf: 1.0 / self.area() })
    }

    fn sample_from(&self, place: DVec3, u: [f64; 2]) -> Option<Drawn> {
        let from = self.frame().to_local(place - self.center);
        let Some(seen) = self.seen(from) else {
            let drawn = self.sample(u)?;
            let pdf = self.pdf_from(place, drawn.point.position - place);
            return (pdf > 0.0).then_some(Drawn { pdf, ..drawn });
        };
        let ([x, y], pdf) = seen.sample(u);
        let (x, y) = (from.x + x, from.y + y);
        let turn = y.atan2(x) / TAU;
        let turn = if turn < 0.0 { (turn + 1.0).min(1.0) } else { turn };
        let v = (1.0 - x.hypot(y) / self.radius).clamp(0.0, 1.0);
        (pdf > 0.0 && pdf.is_finite()).then(|| Drawn { point: self.at([turn, v]), pdf })
    }

    fn pdf_from(&self, place: DVec3, direction: DVec3) -> f64 {
        let frame = self.frame();
        let (from, way) = (frame.to_local(place - self.center), frame.to_local(direction));
        let t = -from.z / way.z;
        let (x, y) = (way.x * t, way.y * t);
        let out = (from.x + x).hypot(from.y + y);
        // Accept points that rounding moved off the rim.
        let slack = 1e-12 * self.radius;
        if !(t > 0.0 && out <= self.radius + slack && out >= self.inner_radius - slack) {
            return 0.0;
        }
        match self.seen(from) {
            Some(seen) => seen.pdf([x, y]),
            None => {
                let length = way.length();
                let distance = t * length;
                distance * distance / (way.z.abs() / length * self.area())
            }
        }
    }
}
