//! Planar polygons, convex or not, with holes.

mod crossing;
mod ear_clipping;
mod outline;
#[cfg(test)]
mod tests;
mod trapezoids;

use super::triangle::{nearest_point, point_of};
use super::{Bounds, Candidate, Closest, Drawn, Flat, Point, Shape};
use crossing::Line;
pub use ear_clipping::triangulate;
use glam::DVec2;
use raywright_base::math::robust::{UNIT, normalising_scale};
use raywright_base::math::{Affine, DVec3, DoubleDouble, Ray};
use trapezoids::{Trapezoid, trapezoids};

/// Maximum distance of points from their plane, as a fraction of the bounding box diagonal.
const FLATNESS: f64 = 1e-6;

/// A planar polygon with holes.
///
/// Whether a line passes through it is decided exactly from the given edges. An edge shared by two polygons, or by a
/// polygon and a triangle, is watertight and hit once. The distance is that of the plane fitted to the points (Newell's
/// normal, at their mean distance), clamped to their bounding box. An exactly edge-on polygon is not hit. The normal is
/// on the side from which the outline is anticlockwise; the orientation of holes does not matter.
///
/// `u` runs along the outline's first edge and `v` to its left, each from 0 to 1 over the outline's extent in that
/// direction. For a rectangle the first point is at (0, 0).
#[derive(Clone, Debug)]
pub struct Polygon {
    /// The outline, then the holes.
    rings: Vec<Vec<DVec3>>,
    bounds: Bounds,
    /// Bound on the coordinates of edge vectors.
    longest: f64,
    anchor: DVec3,
    normal: DVec3,
    /// Maximum distance of points from the plane.
    deviation: f64,
    /// The point with u = v = 0, and the derivatives with respect to u and v.
    corner: DVec3,
    axes: [DVec3; 2],
    area: f64,
    /// The coordinates that remain in the axis-aligned projection of the plane.
    kept: [usize; 2],
    parts: Vec<Trapezoid>,
    /// Cumulative fractions of the area.
    shares: Vec<f64>,
}

impl Polygon {
    /// Create a polygon from its outline and holes, each of at least three points, without repeating the first.
    ///
    /// # Errors
    ///
    /// A one-line message with the reason and place. It is returned if a ring has fewer points, a point is not finite,
    /// or all lie on one line. So it is if a point is off the plane by more than a millionth of the bounding box
    /// diagonal, rings cross or touch themselves or each other, or a hole is outside the outline or inside another
    /// hole.
    pub fn new(outline: Vec<DVec3>, holes: Vec<Vec<DVec3>>) -> Result<Self, String> {
        let mut rings = vec![outline];
        rings.extend(holes);
        for (r, ring) in rings.iter().enumerate() {
            let name = outline::name(r);
            if ring.len() < 3 {
                return Err(format!("{name} has {} points, expected at least 3", ring.len()));
            }
            if let Some(i) = ring.iter().position(|p| !p.is_finite()) {
                return Err(format!("point {i} of {name} is {}, expected finite numbers", ring[i]));
            }
        }
        let all = || rings.iter().flatten().copied();
        let bounds =
            Bounds { min: all().fold(DVec3::INFINITY, DVec3::min), max: all().fold(DVec3::NEG_INFINITY, DVec3::max) };
        let size = (bounds.max - bounds.min).max_element();
        if !(size < f64::MAX / 4.0 && size > 1e-150) {
            return Err(format!("the polygon's extent is {size:e}, expected 1e-150 to 4e307"));
        }
        let (scale, inverse) = normalising_scale(size);
        let first = rings[0][0];
        let newell = |ring: &[DVec3]| {
            let relative = |i: usize| ((ring[i % ring.len()] - first) * scale).to_array();
            let mut normal = [DoubleDouble::ZERO; 3];
            for i in 0..ring.len() {
                let (a, b) = (relative(i), relative(i + 1));
                for (k, n) in normal.iter_mut().enumerate() {
                    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                    *n = *n + DoubleDouble::product(a[i], b[j]) - DoubleDouble::product(a[j], b[i]);
                }
            }
            DVec3::from_array(normal.map(DoubleDouble::to_f64))
        };
        let whole = newell(&rings[0]);
        let Some(normal) = whole.try_normalize() else {
            return Err("the outline encloses no area: its points lie on one line, or it crosses itself".to_owned());
        };
        let offset = |p: DVec3| normal.dot((p - first) * scale);
        let count = all().count() as f64;
        let mean = all().map(offset).sum::<f64>() / count;
        let diagonal = (bounds.max - bounds.min).length();
        let (mut deviation, mut worst) = (0f64, (0, 0));
        for (r, ring) in rings.iter().enumerate() {
            for (i, &p) in ring.iter().enumerate() {
                let off = (offset(p) - mean).abs() * inverse;
                if off > deviation {
                    (deviation, worst) = (off, (r, i));
                }
            }
        }
        if deviation > FLATNESS * diagonal {
            let (ring, i) = (outline::name(worst.0), worst.1);
            return Err(format!(
                "point {i} of {ring} lies {deviation:.3e} off the plane, expected at most {:.3e}",
                FLATNESS * diagonal
            ));
        }

        let across = normal.abs();
        let dropped =
            if across.x == across.max_element() { 0 } else { 2 - usize::from(across.y == across.max_element()) };
        let kept = [(dropped + 1) % 3, (dropped + 2) % 3];
        // Dropping a coordinate rounds nothing.
        let flat: Vec<Vec<DVec2>> =
            rings.iter().map(|ring| ring.iter().map(|p| DVec2::new(p[kept[0]], p[kept[1]])).collect()).collect();
        outline::check(&flat)?;
        let parts = trapezoids(&flat);
        let areas: Vec<f64> = parts.iter().map(|p| p.area() * scale * scale).collect();
        let sum: f64 = areas.iter().sum();
        let shares = areas
            .iter()
            .scan(0.0, |done, a| {
                *done += a / sum;
                Some(*done)
            })
            .collect();
        let holes: f64 = rings[1..].iter().map(|ring| newell(ring).length()).sum();
        let area = 0.5 * (whole.length() - holes) * inverse * inverse;

        let anchor = first + normal * (mean * inverse);
        let edge = (rings[0][1] - first) * scale;
        let along = (edge - normal * normal.dot(edge)).normalize();
        let up = normal.cross(along);
        let extent = |axis: DVec3| {
            let places = rings[0].iter().map(|&p| axis.dot((p - first) * scale));
            places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
        };
        let ((left, right), (low, high)) = (extent(along), extent(up));
        let corner = anchor + (along * left + up * low) * inverse;
        let axes = [along * ((right - left) * inverse), up * ((high - low) * inverse)];
        let longest = rings
            .iter()
            .flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)).map(|(&v, &w)| (v - w).abs().max_element()))
            .fold(0.0, f64::max);
        Ok(Self { rings, bounds, longest, anchor, normal, deviation, corner, axes, area, kept, parts, shares })
    }

    /// The intersection of a line with the plane: its parameter, and the point relative to that of u = v = 0.
    /// Double-double arithmetic keeps the digits for far origins and grazing directions.
    fn crossing(&self, ray: &Ray) -> Option<(f64, DVec3)> {
        let [o, d, n, anchor] = [ray.origin, ray.direction, self.normal, self.anchor].map(|v| v.to_array());
        let (scale, _) = normalising_scale(ray.direction.abs().max_element());
        let d = d.map(|x| x * scale);
        let (mut above, mut slope) = (DoubleDouble::ZERO, DoubleDouble::ZERO);
        for i in 0..3 {
            above = above + DoubleDouble::difference(anchor[i], o[i]) * DoubleDouble::from(n[i]);
            slope = slope + DoubleDouble::product(d[i], n[i]);
        }
        let k = (0..3).find(|&k| d[k].abs() >= 1.0)?;
        // The line passes through the convex hull of the points, so its intersection lies between their least and
        // greatest depth.
        let depth = [self.bounds.min[k], self.bounds.max[k]].map(|x| DoubleDouble::difference(x, o[k]) / d[k].into());
        let (near, far) = if d[k] > 0.0 { (depth[0], depth[1]) } else { (depth[1], depth[0]) };
        let t = if slope == DoubleDouble::ZERO { (near + far).scaled(0.5) } else { above / slope };
        let t = if t < near {
            near
        } else if t > far {
            far
        } else {
            t
        };
        let corner = self.corner.to_array();
        let mut relative = [0.0; 3];
        for i in 0..3 {
            relative[i] = (DoubleDouble::difference(o[i], corner[i]) + t * DoubleDouble::from(d[i])).to_f64();
        }
        Some((t.to_f64() * scale, DVec3::from_array(relative)))
    }

    fn point_at(&self, [u, v]: [f64; 2]) -> Point {
        let position = self.corner + self.axes[0] * u + self.axes[1] * v;
        let extent = self.bounds.min.abs().max(self.bounds.max.abs()).max_element();
        Point {
            position,
            error: self.deviation + 16.0 * UNIT * extent,
            normal: self.normal,
            uv: [u, v],
            dp: self.axes,
            dn: [DVec3::ZERO; 2],
        }
    }

    fn uv(&self, relative: DVec3) -> [f64; 2] {
        self.axes.map(|axis| {
            let (scale, _) = normalising_scale(axis.abs().max_element());
            let unit = axis * scale;
            (unit.dot(relative * scale) / unit.length_squared()).clamp(0.0, 1.0)
        })
    }
}

impl Polygon {
    /// A point of the plane, from its two projected coordinates, relative to that of u = v = 0.
    fn relative_to_corner(&self, flat: DVec2) -> DVec3 {
        let mut relative = [0.0; 3];
        let (i, j) = (self.kept[0], self.kept[1]);
        let k = 3 - i - j;
        (relative[i], relative[j]) = (flat.x - self.corner[i], flat.y - self.corner[j]);
        relative[k] = -(relative[i] * self.normal[i] + relative[j] * self.normal[j]) / self.normal[k];
        DVec3::from_array(relative)
    }

    /// Its edges, as the rings go.
    fn edges(&self) -> impl Iterator<Item = (DVec3, DVec3)> {
        self.rings.iter().flat_map(|ring| ring.iter().copied().zip(ring.iter().copied().cycle().skip(1)))
    }

    /// Return whether a point of the plane is inside the outline and outside all holes.
    fn holds(&self, foot: DVec3) -> bool {
        let [i, j] = self.kept;
        let is_crossed = |(a, b): &(DVec3, DVec3)| {
            (a[j] > foot[j]) != (b[j] > foot[j]) && foot[i] < a[i] + (b[i] - a[i]) * ((foot[j] - a[j]) / (b[j] - a[j]))
        };
        self.edges().filter(is_crossed).count() % 2 == 1
    }
}

impl Shape for Polygon {
    fn flats(&self) -> Vec<Flat> {
        let triangles = self.parts.iter().flat_map(|part| {
            let [a, b, c, d] = part.corners().map(|corner| self.corner + self.relative_to_corner(corner));
            [[a, b, c], [a, c, d]]
        });
        let outwards = triangles.map(|[a, b, c]| {
            let is_turned = (b - a).cross(c - a).dot(self.normal) < 0.0;
            Flat::Triangle(if is_turned { [a, c, b] } else { [a, b, c] })
        });
        outwards.collect()
    }

    fn is_closed(&self) -> bool {
        false
    }

    fn closest(&self, place: DVec3) -> Option<Closest> {
        let foot = place - self.normal * self.normal.dot(place - self.anchor);
        if self.holds(foot) {
            return Some(Closest { position: foot, uv: self.uv(foot - self.corner) });
        }
        // An edge is a degenerate triangle.
        let near = self.edges().map(|(a, b)| ([a, b, b], nearest_point([a, b, b], place)));
        let (edge, found) = near.min_by(|(_, a), (_, b)| a.distance.total_cmp(&b.distance))?;
        let position = point_of(edge, found.uv);
        Some(Closest { position, uv: self.uv(position - self.corner) })
    }

    fn closest_stretched(&self, to_world: &Affine, to_object: &Affine, place: DVec3) -> Option<Closest> {
        let normal = to_world.normal(self.normal).normalize();
        let foot = place - normal * normal.dot(place - to_world.point(self.anchor));
        let own = to_object.point(foot);
        if self.holds(own) {
            // Far from the plane, the foot of the perpendicular has lost digits: project it again.
            let own = own - self.normal * self.normal.dot(own - self.anchor);
            return Some(Closest { position: to_world.point(own), uv: self.uv(own - self.corner) });
        }
        let moved = self.edges().map(|(a, b)| [a, b].map(|end| to_world.point(end)));
        let near = moved.map(|[a, b]| ([a, b, b], nearest_point([a, b, b], place)));
        let (edge, found) = near.min_by(|(_, a), (_, b)| a.distance.total_cmp(&b.distance))?;
        let position = point_of(edge, found.uv);
        Some(Closest { position, uv: self.uv(to_object.point(position) - self.corner) })
    }

    fn bounds(&self) -> Bounds {
        // Points of the plane near the edges deviate from them by no more than this.
        let room = DVec3::splat(self.deviation);
        let (min, max) = (self.bounds.min - room, self.bounds.max + room);
        let exact = self.deviation == 0.0;
        if exact { self.bounds } else { Bounds { min: min.map(f64::next_down), max: max.map(f64::next_up) } }
    }

    fn meet(&self, ray: &Ray, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
        let finite = ray.origin.is_finite() && ray.direction.is_finite();
        let possible = ray.direction.abs().max_element() >= f64::MIN_POSITIVE && ray.t_min <= ray.t_max;
        if !(finite && possible) {
            return false;
        }
        let (below, above) = (ray.origin - self.bounds.min, self.bounds.max - ray.origin);
        let largest = below.abs().max(above.abs()).max_element();
        let Some(contact) = Line::new(ray, largest, self.longest).meet(&self.rings) else { return false };
        match self.crossing(ray) {
            Some((t, relative)) if t >= ray.t_min && t <= ray.t_max && t.is_finite() => {
                met(Candidate { t, uv: self.uv(relative), contact, inner: 0 })
            }
            _ => false,
        }
    }

    fn point(&self, _ray: &Ray, _t: f64, uv: [f64; 2]) -> Point {
        self.point_at(uv)
    }

    fn area(&self) -> f64 {
        self.area
    }

    fn sample(&self, u: [f64; 2]) -> Option<Drawn> {
        let part = self.shares.partition_point(|&s| s <= u[0]).min(self.parts.len().checked_sub(1)?);
        let before = if part > 0 { self.shares[part - 1] } else { 0.0 };
        // Stretch the remainder of the number that chose the part, so that nearby numbers give nearby points.
        let rest = ((u[0] - before) / (self.shares[part] - before)).clamp(0.0, 1.0);
        let point = self.point_at(self.uv(self.relative_to_corner(self.parts[part].sample([rest, u[1]]))));
        Some(Drawn { point, pdf: 1.0 / self.area })
    }
}
