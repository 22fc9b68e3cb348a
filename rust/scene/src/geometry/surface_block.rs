//! Where rays of paths meet surfaces, sixteen at a time.

use super::{Geometry, Vertices, unit_normal};
use crate::RayOrigin;
use raywright_accel::Primitives;
use raywright_base::math::robust::greater as largest;
use raywright_base::math::single::{greater, lesser, mask};
use raywright_base::math::{DVec3, Hit, LANES, PathRays, SingleLanes, Vec3, VectorLanes, gather};
use raywright_base::simd::{Level, loops};

/// Points of surfaces that rays have met, a lane each.
#[derive(Clone, Debug)]
pub struct SurfaceBlock {
    /// How many lanes count.
    pub count: usize,
    /// The rays' places in their queue.
    pub index: [u32; LANES],
    /// Unit directions of the rays.
    pub direction: SingleLanes,
    /// The points, to within a rounding of their surfaces.
    pub position: VectorLanes,
    /// Where rays leave to the side that the ray came from.
    pub origin: VectorLanes,
    /// Unit normals of the surfaces, on the side that the ray came from.
    pub normal: SingleLanes,
    /// Cosine of the angle between ray and normal.
    pub cosine: [f32; LANES],
    /// Whether the ray came from the side of the surface's own normal: all bits or none.
    pub is_front: [u32; LANES],
    /// Which primitives.
    pub primitive: [u32; LANES],
    /// Of which shapes.
    pub shape: [u32; LANES],
    /// Weights of the second and third corners of triangles.
    pub uv: [[f64; LANES]; 2],
}

/// Corners and normals of triangles, a lane each.
struct Corners {
    corners: [VectorLanes; 3],
    normal: VectorLanes,
}

impl Corners {
    #[inline(always)]
    fn set(&mut self, lane: usize, [a, b, c]: [DVec3; 3]) {
        self.corners[0].set(lane, a);
        self.corners[1].set(lane, b);
        self.corners[2].set(lane, c);
    }
}

impl SurfaceBlock {
    /// Of no rays.
    pub const NONE: Self = Self {
        count: 0,
        index: [0; LANES],
        direction: SingleLanes::ZERO,
        position: VectorLanes::ZERO,
        origin: VectorLanes::ZERO,
        normal: SingleLanes::ZERO,
        cosine: [0.0; LANES],
        is_front: [0; LANES],
        primitive: [0; LANES],
        shape: [0; LANES],
        uv: [[0.0; LANES]; 2],
    };

    /// Where rays leave to the other side.
    #[inline(always)]
    pub fn origin_behind(&self, lane: usize) -> DVec3 {
        let position = self.position.get(lane);
        position - (self.origin.get(lane) - position)
    }

    /// The origin of rays that leave to either side.
    #[inline]
    pub fn ray_origin(&self, lane: usize) -> RayOrigin {
        let position = self.position.get(lane);
        RayOrigin::with(position, self.origin.get(lane) - position)
    }
}

loops! {
    /// Unit normals by corners.
    fn normals(corners: &[VectorLanes; 3], normal: &mut VectorLanes) {
        for i in 0..LANES {
            normal.set(i, unit_normal([corners[0].get(i), corners[1].get(i), corners[2].get(i)]));
        }
    }
}

/// What [`super::error_among`] gives for corners that are no NaN.
#[inline(always)]
fn error_of_lanes(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let x = largest(largest(a.x.abs(), b.x.abs()), c.x.abs());
    let y = largest(largest(a.y.abs(), b.y.abs()), c.y.abs());
    let z = largest(largest(a.z.abs(), b.z.abs()), c.z.abs());
    8.0 * f64::EPSILON * largest(largest(x, y), z)
}

loops! {
    /// Where rays meet triangles, by Möller and Trumbore ("Fast, Minimum Storage Ray/Triangle Intersection", 1997).
    /// That they do is known, so the weights of corners are brought into their range: the point lies on its triangle
    /// whatever f32 rounds.
    #[allow(clippy::too_many_arguments)]
    fn meet(
        triangles: &Corners,
        origin: &VectorLanes,
        direction: &SingleLanes,
        position: &mut VectorLanes,
        leaves: &mut VectorLanes,
        normal: &mut SingleLanes,
        cosine: &mut [f32; LANES],
        is_front: &mut [u32; LANES],
        uv: &mut [[f64; LANES]; 2],
    ) {
        for i in 0..LANES {
            let (a, b, c) = (triangles.corners[0].get(i), triangles.corners[1].get(i), triangles.corners[2].get(i));
            let of_triangle = triangles.normal.get(i);
            let error = error_of_lanes(a, b, c);
            let d = direction.get(i);
            let from_a = origin.get(i) - a;
            let (first, second, from) = ((b - a).as_vec3(), (c - a).as_vec3(), from_a.as_vec3());
            let across = d.cross(second);
            let inverse = 1.0 / first.dot(across);
            let over = from.cross(first);
            let (v, w) = (from.dot(across) * inverse, d.dot(over) * inverse);
            // Also of NaN, where a triangle is next to edge-on.
            let (v, w) = (greater(v, 0.0), greater(w, 0.0));
            let sum = 1.0 / greater(v + w, 1.0);
            let (v, w) = (f64::from(lesser(v * sum, 1.0)), f64::from(lesser(w * sum, 1.0)));
            // The first point errs by 2⁻²³ of the triangle's size, a second step by as much of the ray's length.
            let rest = (origin.get(i) - (a * (1.0 - v - w) + b * v + c * w)).as_vec3();
            let v = v + f64::from(rest.dot(across) * inverse);
            let w = w + f64::from(d.dot(rest.cross(first)) * inverse);
            let (v, w) = (largest(v, 0.0), largest(w, 0.0));
            let (v, w) = (if v < 1.0 { v } else { 1.0 }, if w < 1.0 { w } else { 1.0 });
            let excess = 0.5 * largest(v + w - 1.0, 0.0);
            let (v, w) = (largest(v - excess, 0.0), largest(w - excess, 0.0));
            let point = a * (1.0 - v - w) + b * v + c * w;
            let slope = of_triangle.as_vec3().dot(d);
            let front = mask(slope < 0.0);
            let side = if slope < 0.0 { 1.0 } else { -1.0 };
            let off = RayOrigin::off(point, error, of_triangle * side);
            position.set(i, point);
            leaves.set(i, off.outside());
            normal.set(i, of_triangle.as_vec3() * side as f32);
            cosine[i] = slope.abs();
            is_front[i] = front;
            (uv[0][i], uv[1][i]) = (v, w);
        }
    }
}

impl Geometry {
    /// What rays meet, by the primitives that each hits first; `which` are their places in the queue, at most sixteen.
    /// The last stands in the lanes that are left. Where primitives do not tell all of the hits, these are given.
    pub fn meet_block(
        &self,
        level: Level,
        rays: &PathRays,
        (primitives, hits): (&[u32], &[Hit]),
        which: &[u32],
        surfaces: &mut SurfaceBlock,
    ) {
        surfaces.count = which.len();
        let mut triangles = Corners { corners: [VectorLanes::ZERO; 3], normal: VectorLanes::ZERO };
        let mut origin = VectorLanes::ZERO;
        let (has_facets, is_single) = (!self.facets.is_empty(), self.few_corners.is_empty());
        for lane in 0..LANES {
            surfaces.index[lane] = which[lane.min(which.len() - 1)];
        }
        gather(primitives, &surfaces.index, &mut surfaces.primitive);
        for axis in 0..3 {
            gather(&rays.direction[axis], &surfaces.index, &mut surfaces.direction.0[axis]);
            gather(&rays.origin[axis], &surfaces.index, origin.axis_mut(axis));
        }
        // All of the hits are given where f32 does not hold the products of two lengths.
        let others = if !hits.is_empty() && self.is_extreme() {
            (1 << LANES) - 1
        } else {
            self.lanes_of_shapes(&surfaces.primitive)
        };
        for lane in (0..LANES).filter(|lane| others >> lane & 1 == 0) {
            let primitive = surfaces.primitive[lane];
            match (self.facets.get(primitive), &self.vertices) {
                (Some(facet), _) => {
                    triangles.normal.set(lane, facet.normal);
                    surfaces.shape[lane] = facet.shape;
                    if is_single {
                        triangles.set(lane, facet.corners.map(Vec3::as_dvec3));
                    } else {
                        triangles.set(lane, self.few_corners[primitive as usize]);
                    }
                }
                // Without a call.
                (None, Vertices::Single(vertices)) if self.gaps.is_empty() => {
                    triangles.set(lane, self.faces[primitive as usize].map(|i| vertices[i as usize].as_dvec3()));
                }
                _ => triangles.set(lane, self.corners(primitive)),
            }
        }
        for lane in (0..LANES).filter(|lane| !has_facets || others >> lane & 1 == 1) {
            surfaces.shape[lane] = self.locate(surfaces.primitive[lane]).0;
        }
        if !has_facets {
            normals(level, &triangles.corners, &mut triangles.normal);
        }
        let SurfaceBlock { direction, position, origin: leaves, normal, cosine, is_front, uv, .. } = surfaces;
        if others != (1 << LANES) - 1 {
            meet(level, &triangles, &origin, direction, position, leaves, normal, cosine, is_front, uv);
        }
        if others != 0 {
            self.meet_shapes(level, (rays, hits), &origin, others, surfaces);
        }
    }
}
