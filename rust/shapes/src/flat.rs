//! Planar parts of shapes.

use raywright_base::math::{Affine, DVec3};
use std::f64::consts::TAU;

/// A planar part of a shape's surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flat {
    /// Corners, anticlockwise as seen from outside.
    Triangle([DVec3; 3]),
    /// The points `center + x axes[0] + y axes[1]` with `inner² ≤ x² + y² ≤ 1`. The cross product of the axes points
    /// outward.
    Ellipse {
        /// Its center.
        center: DVec3,
        /// Conjugate half-axes.
        axes: [DVec3; 2],
        /// The hole's radius as a fraction of the rim's; 0 for none.
        inner: f64,
    },
}

impl Flat {
    /// The image under a map, oriented so that outside stays outside.
    pub fn mapped(&self, map: &Affine) -> Self {
        let is_mirrored = map.determinant() < 0.0;
        match *self {
            Self::Triangle(corners) => {
                let [a, b, c] = corners.map(|corner| map.point(corner));
                Self::Triangle(if is_mirrored { [a, c, b] } else { [a, b, c] })
            }
            Self::Ellipse { center, axes, inner } => {
                let [a, b] = axes.map(|axis| map.vector(axis));
                Self::Ellipse { center: map.point(center), axes: if is_mirrored { [b, a] } else { [a, b] }, inner }
            }
        }
    }

    /// Triangles inside it, which miss 1 % of an ellipse.
    pub fn triangles(&self) -> Vec<[DVec3; 3]> {
        /// Sectors of an ellipse.
        const SECTORS: u32 = 32;
        match *self {
            Self::Triangle(corners) => vec![corners],
            Self::Ellipse { center, axes: [a, b], inner } => {
                let out = |i: u32| {
                    let (sin, cos) = (TAU * f64::from(i % SECTORS) / f64::from(SECTORS)).sin_cos();
                    a * cos + b * sin
                };
                let sector = |i: u32| {
                    let [from, to] = [out(i), out(i + 1)];
                    let hole = [center + from * inner, center + to * inner];
                    let rim = [center + from, center + to];
                    let outer = [hole[0], rim[0], rim[1]];
                    if inner > 0.0 { vec![outer, [hole[0], rim[1], hole[1]]] } else { vec![outer] }
                };
                (0..SECTORS).flat_map(sector).collect()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cuboid, Disk, Drawn, Placed, Polygon, Revolution, Shape, Sphere};
    use std::sync::Arc;

    fn area([a, b, c]: [DVec3; 3]) -> f64 {
        0.5 * (b - a).cross(c - a).length()
    }

    /// Return whether a point with this normal lies on the part, with a tolerance relative to its size.
    fn holds(flat: &Flat, place: DVec3, normal: DVec3, share: f64) -> bool {
        flat.triangles().into_iter().any(|[a, b, c]| {
            let up = (b - a).cross(c - a).normalize();
            let size = share * (b - a).length().max((c - a).length());
            let inside = |from: DVec3, to: DVec3| up.cross((to - from).normalize()).dot(place - from) >= -size;
            up.dot(normal) > 1.0 - 1e-9
                && up.dot(place - a).abs() < 1e-12
                && inside(a, b)
                && inside(b, c)
                && inside(c, a)
        })
    }

    #[test]
    fn points_of_flat_parts_lie_on_them_and_look_outwards() {
        let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let ring = |r: f64| vec![at(-r, -r, 1.0), at(r, -r, 1.0), at(r, r, 1.0), at(-r, r, 1.0)];
        let hole = Polygon::new(ring(2.0), vec![ring(1.0)]).unwrap();
        let shapes: Vec<(Arc<dyn Shape>, f64)> = vec![
            (Arc::new(Cuboid { min: at(0.0, 0.0, 0.0), max: at(1.0, 2.0, 3.0) }), 22.0),
            (Arc::new(Revolution::cylinder(at(0.0, 0.0, 0.0), at(0.0, 2.0, 0.0), 0.5, true)), 0.5),
            (Arc::new(Revolution::cone(at(0.0, 0.0, 0.0), at(1.0, 2.0, 0.0), [0.5, 0.0], true)), 0.25),
            (Arc::new(Revolution::cone(at(0.0, 0.0, 0.0), at(1.0, 2.0, 0.0), [0.5, 0.25], true)), 0.3125),
            (Arc::new(Revolution::cone(at(0.0, 0.0, 0.0), at(1.0, 2.0, 0.0), [0.5, 0.25], false)), 0.0),
            (Arc::new(Revolution::paraboloid(at(0.0, 0.0, 0.0), at(1.0, 2.0, 0.0), 0.5, true)), 0.25),
            (
                Arc::new(Disk { center: at(1.0, 0.0, 0.0), normal: at(1.0, 1.0, 0.0), radius: 2.0, inner_radius: 1.0 }),
                3.0,
            ),
            (Arc::new(hole), 12.0),
            (Arc::new(Sphere { center: at(0.0, 0.0, 0.0), radius: 1.0 }), 0.0),
        ];
        let mirrored = Affine::new([at(1.0, 0.5, 0.0), at(0.0, 1.0, 0.0), at(0.0, 0.0, -2.0)], at(3.0, 1.0, 0.0));
        for (shape, flat_area) in shapes {
            // Disk areas are in units of π.
            let flats = shape.flats();
            let is_round = flats.iter().any(|flat| matches!(flat, Flat::Ellipse { .. }));
            let wanted = flat_area * if is_round { std::f64::consts::PI } else { 1.0 };
            let sum: f64 = flats.iter().flat_map(Flat::triangles).map(area).sum();
            let left = if is_round { 0.0065 } else { 1e-12 };
            assert!(sum <= wanted * (1.0 + 1e-12) && sum >= wanted * (1.0 - left), "{shape:?}: {sum} for {wanted}");
            let placed = Placed::new(shape.clone(), mirrored.clone()).unwrap();
            for shape in [&*shape as &dyn Shape, &placed] {
                let flats = shape.flats();
                let mut met = 0;
                for i in 0..400u32 {
                    let u = [f64::from(i % 20) + 0.47, f64::from(i / 20) + 0.53].map(|x| x / 20.0);
                    let Drawn { point, .. } = shape.sample(u).unwrap();
                    let on = flats.iter().filter(|flat| holds(flat, point.position, point.normal, 0.01)).count();
                    let is_flat = flats.iter().any(|flat| {
                        let [a, b, c] = flat.triangles()[0];
                        (b - a).cross(c - a).normalize().dot(point.normal) > 1.0 - 1e-9
                    });
                    assert_eq!(on > 0, is_flat, "{shape:?} {point:?}");
                    met += u32::from(on > 0);
                }
                assert_eq!(met > 0, flat_area > 0.0, "{shape:?}");
            }
        }
    }
}
