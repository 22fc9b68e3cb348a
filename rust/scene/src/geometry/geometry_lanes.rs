//! Surface points of hits in batches of sixteen lanes.

use super::{Geometry, NO_FACE, error_among, unit_normal};
use crate::SurfaceLanes;
use raywright_accel::Primitives;
use raywright_base::math::{Hit, LANES, Ray, Vec3, VectorLanes};
use raywright_base::sampling::Pairs;
use raywright_base::simd::{Level, loops};

loops! {
    /// Unit normals of triangles.
    fn normals(corners: &[VectorLanes; 3], normal: &mut VectorLanes) {
        for i in 0..LANES {
            normal.set(i, unit_normal([corners[0].get(i), corners[1].get(i), corners[2].get(i)]));
        }
    }
}

loops! {
    /// Points of triangles at barycentric coordinates.
    fn points(
        corners: &[VectorLanes; 3],
        uv: &Pairs,
        position: &mut VectorLanes,
        error: &mut [f64; LANES],
    ) {
        for i in 0..LANES {
            let [a, b, c] = [corners[0].get(i), corners[1].get(i), corners[2].get(i)];
            let [v, w] = [uv[0][i], uv[1][i]];
            position.set(i, a * (1.0 - v - w) + b * v + c * w);
            error[i] = error_among([a, b, c]);
        }
    }
}

impl Geometry {
    /// Points of triangles by the weights of their second and third corners, a lane each; their shading normals are not
    /// computed.
    ///
    /// # Panics
    /// If a primitive is not there.
    pub fn triangle_lanes(&self, level: Level, primitives: &[u32; LANES], uv: &Pairs, surfaces: &mut SurfaceLanes) {
        let mut corners = [VectorLanes::ZERO; 3];
        let has_facets = self.is_single() && self.facets.get(0).is_some();
        for (lane, &primitive) in primitives.iter().enumerate() {
            let (of_face, shape) = match self.facets.get(primitive) {
                Some(facet) if has_facets => {
                    surfaces.normal.set(lane, facet.normal);
                    (facet.corners.map(Vec3::as_dvec3), facet.shape)
                }
                _ => (self.corners(primitive), self.locate(primitive).0),
            };
            for (corners, corner) in corners.iter_mut().zip(of_face) {
                corners.set(lane, corner);
            }
            surfaces.shape[lane] = shape;
        }
        if !has_facets {
            normals(level, &corners, &mut surfaces.normal);
        }
        let SurfaceLanes { position, error, .. } = surfaces;
        points(level, &corners, uv, position, error);
    }

    /// What [`Geometry::surface`] gives for a ray and its hit, a lane each.
    ///
    /// # Panics
    /// If one is a miss.
    pub fn surface_lanes(&self, level: Level, rays: &[Ray; LANES], hits: &[Hit; LANES], surfaces: &mut SurfaceLanes) {
        let (mut primitives, mut uv) = ([0; LANES], [[0.0; LANES]; 2]);
        for (lane, hit) in hits.iter().enumerate() {
            primitives[lane] = hit.primitive;
            [uv[0][lane], uv[1][lane]] = hit.uv;
        }
        self.triangle_lanes(level, &primitives, &uv, surfaces);
        surfaces.shading_normal = surfaces.normal;
        if !self.normals.is_empty() {
            for (lane, hit) in hits.iter().enumerate() {
                let [v, w] = hit.uv;
                let normal = self.shading_normal(hit.primitive, [1.0 - v - w, v, w], surfaces.normal.get(lane));
                surfaces.shading_normal.set(lane, normal);
            }
        }
        if self.others.is_some() {
            surfaces.inner = [None; LANES];
            for (lane, hit) in hits.iter().enumerate() {
                if self.face(hit.primitive) == NO_FACE {
                    surfaces.set(lane, &self.surface(&rays[lane], hit));
                }
            }
        }
    }
}
