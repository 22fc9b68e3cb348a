//! Filtered ray queries: a subset of shapes, or front faces only.

use super::geometry::{is_front_of, scaled};
use super::{Geometry, Scene};
use raywright_accel::{Crossings, Primitives};
use raywright_base::math::{Hit, Ray};
use raywright_shapes::Candidate;

/// A filter on hits. Results equal those of a scene without the filtered surfaces.
#[derive(Clone, Debug, Default)]
pub struct Filter {
    /// One flag per shape: true if it counts. `None` counts all shapes; a shape beyond the end does not count.
    pub shapes: Option<Vec<bool>>,
    /// Counts a surface only if its geometric normal points against the ray.
    pub is_front_only: bool,
}

impl Filter {
    /// The closest hit of each ray or, if `any` is set, any hit.
    pub fn intersect(&self, scene: &Scene, rays: &[Ray], any: bool, hits: &mut [Hit]) {
        let counts =
            |i: usize, primitive: u32, met: &Candidate| self.counts(scene.geometry(), &rays[i], primitive, met);
        scene.accelerator().kept(rays, &counts, any, hits);
    }

    /// Every hit of each ray.
    pub fn crossings(&self, scene: &Scene, rays: &[Ray]) -> Crossings {
        let counts =
            |i: usize, primitive: u32, met: &Candidate| self.counts(scene.geometry(), &rays[i], primitive, met);
        scene.accelerator().crossings_kept(rays, &counts)
    }

    fn counts(&self, geometry: &Geometry, ray: &Ray, primitive: u32, met: &Candidate) -> bool {
        if let Some(shapes) = &self.shapes
            && !shapes.get(geometry.locate(primitive).0 as usize).is_some_and(|&counts| counts)
        {
            return false;
        }
        !self.is_front_only || is_front(geometry, ray, primitive, met)
    }
}

/// Returns whether a ray arrives on the side of the geometric normal. The decision is exact for triangles; curved
/// shapes and instances use the normal in f64.
fn is_front(geometry: &Geometry, ray: &Ray, primitive: u32, met: &Candidate) -> bool {
    if geometry.shape(primitive).is_none() && geometry.instance(primitive).is_none() {
        return is_front_of(geometry.corners(primitive), ray);
    }
    let (scale, direction) = scaled(ray);
    let hit = Hit { t: met.t * scale, uv: met.uv, primitive, inner: met.inner };
    geometry.surface(ray, &hit).normal.dot(direction) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::shape;
    use crate::{Mesh, SceneDescription};
    use raywright_accel::bvh::Options;
    use raywright_accel::trees;
    use raywright_base::math::DVec3;
    use raywright_base::sampling::{Sampler, warp};
    use raywright_base::simd::Level;

    /// Triangles from regular to needle-thin, large and small, near the origin and far from it.
    fn corners(seed: u32) -> [DVec3; 3] {
        let (mut sampler, mut dimension) = (Sampler::new(5, 0, seed), 0);
        let mut next = || {
            dimension += 1;
            warp::uniform_sphere(sampler.two(dimension))
        };
        let middle = next() * [0.0, 1.0, 1e6][seed as usize % 3];
        [0; 3].map(|_| middle + next() * [1e-6, 1.0, 1e3][(seed / 3) as usize % 3])
    }

    #[test]
    fn what_does_not_count_is_as_if_it_were_not_there() {
        let mesh = |from: u32| Mesh {
            vertices: (from..from + 60)
                .flat_map(|i| corners(9 * i + 4))
                .map(|v| v.as_vec3())
                .collect::<Vec<_>>()
                .into(),
            faces: (0..60).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
            normals: None,
            ..Mesh::default()
        };
        let scene = |from: &[u32]| {
            let shapes = from.iter().map(|&from| shape(mesh(from), [0.5; 3], 0.0)).collect();
            Scene::new(SceneDescription { shapes, ..Default::default() }, |geometry| {
                trees::over(geometry, &Options::default(), Level::current().unwrap())
            })
            .unwrap()
        };
        let (all, last) = (scene(&[0, 100, 200]), scene(&[200]));
        let filter = Filter { shapes: Some(vec![false, false, true]), is_front_only: false };
        let mut sampler = Sampler::new(6, 0, 0);
        let rays: Vec<_> = (0..2000)
            .map(|i| {
                let origin = warp::uniform_sphere(sampler.two(2 * i)) * 3.0;
                Ray::new(origin, warp::uniform_sphere(sampler.two(2 * i + 1)) - origin)
            })
            .collect();
        let (mut hits, mut wanted) = (vec![Hit::MISS; rays.len()], vec![Hit::MISS; rays.len()]);
        filter.intersect(&all, &rays, false, &mut hits);
        last.intersect(&rays, &mut wanted);
        let same = |hit: &Hit, wanted: &Hit| {
            hit.is_hit() == wanted.is_hit()
                && (!hit.is_hit() || (hit.primitive == wanted.primitive + 120 && hit.t == wanted.t))
        };
        assert!(hits.iter().zip(&wanted).all(|(hit, wanted)| same(hit, wanted)));
        assert!(wanted.iter().filter(|hit| hit.is_hit()).count() > 200);
        let mut any = vec![Hit::MISS; rays.len()];
        filter.intersect(&all, &rays, true, &mut any);
        assert!(any.iter().zip(&wanted).all(|(hit, wanted)| hit.is_hit() == wanted.is_hit()));
        let crossings = filter.crossings(&all, &rays);
        assert_eq!(crossings.splits, last.crossings(&rays).splits);
    }
}
