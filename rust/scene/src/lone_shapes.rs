//! Closed convex shapes that nothing else is near: where a ray hits one of them, it crosses no other surface.
//!
//! Surfaces that coincide are one boundary of media, so every hit of one asks for the others around it. Around most
//! media and most glass there is nothing, which their boxes and planes tell once for all rays.

use super::{Geometry, RayOrigin, SurfaceBlock, SurfacePoint};
use raywright_accel::Primitives;
use raywright_base::math::{DVec3, Hit, Ray};

/// The shapes of a scene that stand alone.
#[derive(Clone, Debug, Default)]
pub struct LoneShapes {
    /// By shape; empty if none stands alone.
    gaps: Vec<Gap>,
}

/// What is known around a shape.
#[derive(Clone, Copy, Debug, Default)]
struct Gap {
    /// A lower bound on the distance along a ray, from a hit off the edges, to any other surface and to the other side
    /// of the shape; 0 if unknown.
    length: f64,
    has_edges: bool,
    /// Nothing is inside.
    is_empty: bool,
}

/// Shapes of more triangles are not compared with each other, and of more boxes with one around all of them.
const FEW: usize = 64;

/// More closed shapes than these are not examined.
const MOST: usize = 64;

/// The least barycentric weight of a hit off the edges.
const OFF_EDGES: f64 = 1e-6;

/// The least cosine of a hit of a sphere that does not graze it.
const STEEP: f64 = 1e-3;

/// A box by its lower and upper corner.
type Extent = [DVec3; 2];

/// A convex solid.
enum Convex {
    /// Planes, by outward unit normal and distance from the origin, and the least distance of a corner from a plane
    /// that it is not on.
    Planes(Vec<(DVec3, f64)>, f64),
    /// Center and radius.
    Ball(DVec3, f64),
}

impl LoneShapes {
    /// Examines the shapes that enclose something.
    pub(super) fn of(geometry: &Geometry, encloses: impl Fn(u32) -> bool) -> Self {
        let shapes = 0..geometry.shapes() as u32;
        let closed: Vec<u32> = shapes.clone().filter(|&shape| encloses(shape)).collect();
        if closed.is_empty() || closed.len() > MOST || geometry.moves() {
            return Self::default();
        }
        let solids: Vec<Option<Convex>> = shapes
            .clone()
            .map(|shape| if closed.contains(&shape) { Convex::of(geometry, shape) } else { None })
            .collect();
        if solids.iter().all(Option::is_none) {
            return Self::default();
        }
        let boxes: Vec<_> = shapes.map(|shape| boxes(geometry, shape)).collect();
        let gap = |(shape, solid): (usize, &Option<Convex>)| {
            let Some(solid) = solid else { return Gap::default() };
            let others = boxes.iter().enumerate().filter(|&(other, _)| other != shape).flat_map(|(_, boxes)| boxes);
            let (length, is_empty) = others.fold((solid.across(), true), |(length, is_empty), other| {
                let [outside, inside] = solid.gaps(*other);
                (length.min(outside.max(inside)), is_empty && outside > 0.0)
            });
            Gap { length, has_edges: matches!(solid, Convex::Planes(..)), is_empty }
        };
        Self { gaps: solids.iter().enumerate().map(gap).collect() }
    }

    /// Returns whether a shape is convex, touches nothing and has nothing inside: its inner points see each other.
    pub fn is_empty(&self, shape: u32) -> bool {
        self.gaps.get(shape as usize).is_some_and(|gap| gap.is_empty && gap.length > 0.0)
    }

    /// Returns whether a ray certainly crosses no other surface within its reach of a hit, in lengths of its direction
    /// ([`super::RayOrigin::reach`]).
    #[inline]
    pub fn has(&self, ray: &Ray, hit: &Hit, surface: &SurfacePoint, reach: f64) -> bool {
        let length = ray.direction.length();
        let cosine = ray.direction.dot(surface.normal).abs() / length;
        self.is_alone(surface.shape, reach * length, hit.uv, cosine)
    }

    /// The same of a lane of surfaces that rays have met.
    #[inline]
    pub fn has_lane(&self, surfaces: &SurfaceBlock, lane: usize) -> bool {
        let cosine = f64::from(surfaces.cosine[lane]);
        let offset = (surfaces.origin.get(lane) - surfaces.position.get(lane)).length();
        let reach = offset / cosine.max(RayOrigin::GRAZING);
        self.is_alone(surfaces.shape[lane], reach, surfaces.uv.map(|uv| uv[lane]), cosine)
    }

    fn is_alone(&self, shape: u32, reach: f64, [v, w]: [f64; 2], cosine: f64) -> bool {
        let Some(gap) = self.gaps.get(shape as usize) else { return false };
        let is_off_edges = || v > OFF_EDGES && w > OFF_EDGES && 1.0 - v - w > OFF_EDGES;
        gap.length > 4.0 * reach && if gap.has_edges { is_off_edges() } else { cosine > STEEP }
    }
}

/// The boxes of a shape's primitives, or one around all if they are many.
fn boxes(geometry: &Geometry, shape: u32) -> Vec<Extent> {
    let bounds = geometry.primitives_of(shape).filter_map(|primitive| geometry.bounds(primitive));
    let boxes: Vec<Extent> = bounds.map(|bounds| [bounds.min, bounds.max]).collect();
    if boxes.len() <= FEW { boxes } else { boxes.into_iter().reduce(union).into_iter().collect() }
}

fn union(a: Extent, b: Extent) -> Extent {
    [a[0].min(b[0]), a[1].max(b[1])]
}

impl Convex {
    /// The solid of a shape, if it is a sphere or a closed convex mesh of few triangles.
    fn of(geometry: &Geometry, shape: u32) -> Option<Self> {
        let primitives = geometry.primitives_of(shape);
        if geometry.instances_of(shape).is_some() || primitives.len() > FEW {
            return None;
        }
        if let Some((center, radius)) = primitives.clone().next().and_then(|one| geometry.shape(one)?.ball()) {
            return Some(Self::Ball(center, radius));
        }
        let triangles: Vec<[DVec3; 3]> = primitives.map(|primitive| geometry.corners(primitive)).collect();
        let is_finite = triangles.iter().flatten().all(|corner| corner.is_finite());
        if is_finite && is_closed(&triangles) { Self::of_triangles(&triangles) } else { None }
    }

    /// The solid inside triangles that are wound alike, if it is convex.
    fn of_triangles(triangles: &[[DVec3; 3]]) -> Option<Self> {
        let corners = || triangles.iter().flatten().copied();
        let low = corners().fold(DVec3::INFINITY, DVec3::min);
        let high = corners().fold(DVec3::NEG_INFINITY, DVec3::max);
        let middle = corners().sum::<DVec3>() / (3 * triangles.len()) as f64;
        let rounding = 1e-9 * (high - low).max_element();
        let (mut planes, mut least) = (Vec::new(), f64::INFINITY);
        let mut is_outward = None;
        for &[a, b, c] in triangles {
            let normal = (b - a).cross(c - a).try_normalize()?;
            let side = normal.dot(a - middle) > 0.0;
            // On a triangle that is folded over, the winding differs.
            if *is_outward.get_or_insert(side) != side {
                return None;
            }
            let normal = if side { normal } else { -normal };
            for corner in corners() {
                let depth = normal.dot(a - corner);
                if depth < -rounding {
                    return None;
                }
                if depth > rounding {
                    least = least.min(depth);
                }
            }
            planes.push((normal, normal.dot(a)));
        }
        least.is_finite().then_some(Self::Planes(planes, least))
    }

    /// The least way through the solid from a hit off the edges.
    fn across(&self) -> f64 {
        match self {
            // A point off the edges of one triangle is so far from each plane that not all of its corners are on.
            Self::Planes(_, least) => OFF_EDGES * least,
            Self::Ball(_, radius) => STEEP * radius,
        }
    }

    /// Lower bounds on the distance of what is in a box from the solid's surface, if it is outside and if it is inside;
    /// 0 if it may not be.
    fn gaps(&self, [low, high]: Extent) -> [f64; 2] {
        let (middle, half) = (low.midpoint(high), 0.5 * (high - low));
        if !(middle.is_finite() && half.is_finite()) {
            return [0.0; 2];
        }
        match self {
            Self::Planes(planes, _) => {
                let of_plane = |&(normal, distance): &(DVec3, f64)| {
                    let (to_middle, reach) = (normal.dot(middle) - distance, normal.abs().dot(half));
                    (to_middle - reach, -(to_middle + reach))
                };
                let outside = planes.iter().map(|plane| of_plane(plane).0).fold(0.0, f64::max);
                let inside = planes.iter().map(|plane| of_plane(plane).1).fold(f64::INFINITY, f64::min);
                [outside, inside.max(0.0)]
            }
            Self::Ball(center, radius) => {
                let away = (*center - middle).abs();
                let (nearest, farthest) = ((away - half).max(DVec3::ZERO).length(), (away + half).length());
                [(nearest - radius).max(0.0), (radius - farthest).max(0.0)]
            }
        }
    }
}

/// Returns whether each edge of the triangles is that of two, which follow it in opposite directions.
fn is_closed(triangles: &[[DVec3; 3]]) -> bool {
    let edges = || triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    edges().all(|(a, b)| {
        let count = |edge| edges().filter(|other| *other == edge).count();
        count((a, b)) == 1 && count((b, a)) == 1
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{rectangle, scene, shape};
    use crate::{Mesh, RayOrigin, SceneDescription, Shape};
    use raywright_base::math::Vec3;
    use raywright_base::sampling::Sampler;
    use raywright_shapes::Sphere;
    use std::sync::Arc;

    /// A solid of four corners, and of `faces` or all.
    fn tetrahedron(corners: [[f32; 3]; 4], faces: usize) -> Shape {
        let all = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
        let vertices = corners.iter().map(|&corner| Vec3::from(corner)).collect();
        shape(Mesh { vertices, faces: all[..faces].into(), ..Mesh::default() }, [0.5; 3], 0.0)
    }

    const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.2, 1.0, 0.0], [0.3, 0.2, 1.0]];

    fn ball(center: DVec3, radius: f64) -> Shape {
        let ball: Arc<dyn raywright_shapes::Shape> = Arc::new(Sphere { center, radius });
        Shape { surface: ball.into(), ..tetrahedron(CORNERS, 4) }
    }

    /// For rays from all around, the share of the hits of shape 0 around which nothing else is said to be, which the
    /// crossings there have to confirm.
    fn share_alone(shapes: Vec<Shape>) -> f64 {
        let scene = scene(SceneDescription { shapes, ..Default::default() });
        let lone = LoneShapes::of(scene.geometry(), |shape| shape == 0);
        let (mut count, mut alone) = (0, 0);
        for number in 0..20_000 {
            let mut sampler = Sampler::new(7, 0, number);
            let mut point = |at: u32, size: f64| {
                let ([x, y], z) = (sampler.two(at), sampler.one(at + 2));
                (DVec3::new(x, y, z) - 0.5) * size
            };
            let (from, to) = (point(0, 10.0), DVec3::splat(0.4) + point(3, 1.5));
            // Some along the axes, where edges and corners are met.
            let to = if number % 4 == 0 { (8.0 * to).round() / 8.0 } else { to };
            let from = if number % 8 == 0 { DVec3 { z: 9.0, ..to } } else { from };
            let ray = Ray::new(from, to - from);
            let hit = scene.intersect_one(&ray);
            if !hit.is_hit() {
                continue;
            }
            let surface = scene.geometry().surface(&ray, &hit);
            let reach = RayOrigin::reach(&surface, &ray);
            count += u32::from(surface.shape == 0);
            if lone.has(&ray, &hit, &surface, reach) {
                alone += 1;
                let window = Ray { t_min: hit.t - 4.0 * reach, t_max: hit.t + 4.0 * reach, ..ray };
                assert_eq!(scene.crossings(&[window]).of_ray(0), [hit], "{ray:?}");
            }
        }
        assert!(count > 500, "{count} hits");
        f64::from(alone) / f64::from(count)
    }

    #[test]
    fn nothing_is_near_a_hit_of_a_shape_that_stands_alone() {
        let floor = |height: f32| {
            let mesh = rectangle([-4.0, -4.0, height], [8.0, 0.0, 0.0], [0.0, 8.0, 0.0]);
            shape(mesh, [0.5; 3], 0.0)
        };
        let solid = || tetrahedron(CORNERS, 4);
        // Rays through edges and corners are not said to be alone.
        assert!(share_alone(vec![solid(), floor(-0.01)]) > 0.9);
        assert!(share_alone(vec![ball(DVec3::splat(0.4), 0.5), floor(-0.2)]) > 0.99);
        // A ball inside, and one around.
        assert!(share_alone(vec![ball(DVec3::splat(0.4), 0.5), ball(DVec3::splat(0.4), 0.2)]) > 0.99);
        assert!(share_alone(vec![solid(), ball(DVec3::new(0.35, 0.3, 0.25), 0.01)]) > 0.9);
        // Where other shapes touch it or cut it, or it is not closed, nothing is said.
        assert_eq!(share_alone(vec![solid(), floor(0.0)]), 0.0);
        assert_eq!(share_alone(vec![solid(), floor(0.5)]), 0.0);
        assert_eq!(share_alone(vec![ball(DVec3::splat(0.4), 0.5), ball(DVec3::splat(0.4), 0.5)]), 0.0);
        assert_eq!(share_alone(vec![solid(), solid()]), 0.0);
        assert_eq!(share_alone(vec![tetrahedron(CORNERS, 3)]), 0.0);
    }

    #[test]
    fn a_shape_is_empty_if_all_others_are_outside() {
        let is_empty = |other: Shape| {
            let shapes = vec![tetrahedron(CORNERS, 4), other];
            let scene = scene(SceneDescription { shapes, ..Default::default() });
            LoneShapes::of(scene.geometry(), |shape| shape == 0).is_empty(0)
        };
        assert!(is_empty(ball(DVec3::new(0.35, 0.3, -0.5), 0.1)));
        assert!(!is_empty(ball(DVec3::new(0.35, 0.3, 0.25), 0.01)));
        assert!(!is_empty(ball(DVec3::new(0.35, 0.3, 0.0), 0.01)));
    }

    #[test]
    fn solids_that_are_not_convex_or_have_two_walls_are_not_examined() {
        let corners = CORNERS.map(|corner| Vec3::from(corner).as_dvec3());
        let [a, b, c, d] = corners;
        let faces = [[a, c, b], [a, b, d], [b, c, d], [a, d, c]];
        assert!(is_closed(&faces) && Convex::of_triangles(&faces).is_some());
        assert!(!is_closed(&[faces, faces].concat()));
        // The top is pushed through the bottom of one face.
        let inner = (a + b + d) / 3.0 * 0.4 + c * 0.6;
        let dented = [[a, c, b], [b, c, d], [a, d, c], [a, b, inner], [b, d, inner], [d, a, inner]];
        assert!(is_closed(&dented) && Convex::of_triangles(&dented).is_none());
        // One face over another encloses nothing.
        assert!(Convex::of_triangles(&[[a, b, c], [a, c, b]]).is_none());
    }
}
