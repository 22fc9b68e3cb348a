//! Where rays of paths meet spheres and other shapes, sixteen at a time.

use super::{Geometry, SurfaceBlock};
use crate::RayOrigin;
use raywright_base::math::robust::{UNIT, greater};
use raywright_base::math::single::{choose, choose_vector, mask};
use raywright_base::math::{DVec3, Hit, LANES, PathRays, Ray, SingleLanes, VectorLanes, select};
use raywright_base::simd::{Level, loops};
use raywright_shapes::Shape;

/// Spheres, a lane each.
struct Spheres {
    center: VectorLanes,
    radius: [f64; LANES],
    /// Whether a lane has one.
    is_here: [bool; LANES],
}

loops! {
    /// Where rays meet spheres, in the lanes that have one: from outside on the near side, from inside on the far side.
    #[allow(clippy::too_many_arguments)]
    fn meet(
        spheres: &Spheres,
        origin: &VectorLanes,
        direction: &SingleLanes,
        position: &mut VectorLanes,
        leaves: &mut VectorLanes,
        normal: &mut SingleLanes,
        cosine: &mut [f32; LANES],
        is_front: &mut [u32; LANES],
    ) {
        for i in 0..LANES {
            let (center, radius, is_here) = (spheres.center.get(i), spheres.radius[i], spheres.is_here[i]);
            let (from, d) = (origin.get(i) - center, direction.get(i).as_dvec3());
            let inverse = 1.0 / d.dot(d);
            let b = from.dot(d) * inverse;
            let across = from - d * b;
            let half = (greater(radius * radius - across.dot(across), 0.0) * inverse).sqrt();
            let outside = (from.dot(from) - radius * radius) * inverse;
            // The root without a difference of numbers that are alike.
            let sum = if b > 0.0 { b + half } else { half - b };
            let t = if outside > 0.0 { outside / sum } else { if b > 0.0 { -outside / sum } else { sum } };
            let point = from + d * t;
            let outward = point * (1.0 / point.dot(point).sqrt());
            let point = center + outward * radius;
            let slope = outward.dot(d);
            let front = if slope < 0.0 { 1.0 } else { -1.0 };
            let largest = greater(greater(point.x.abs(), point.y.abs()), point.z.abs());
            let off = RayOrigin::off(point, UNIT * (largest + 5.0 * radius), outward * front);
            position.set(i, select(is_here, point, position.get(i)));
            leaves.set(i, select(is_here, off.outside(), leaves.get(i)));
            let here = mask(is_here);
            normal.set(i, choose_vector(here, (outward * front).as_vec3(), normal.get(i)));
            cosine[i] = choose(here, slope.abs() as f32, cosine[i]);
            is_front[i] = mask(slope < 0.0) & here | is_front[i] & !here;
        }
    }
}

impl Geometry {
    /// The lanes whose primitives are no triangles, as a mask.
    #[inline]
    pub(super) fn lanes_of_shapes(&self, primitive: &[u32; LANES]) -> u32 {
        let Some(first) = self.others.as_ref().and_then(|others| others.first()) else { return 0 };
        let is_other = |p: u32| p >= first && (self.shape(p).is_some() || self.instance(p).is_some());
        (0..LANES).fold(0, |mask, lane| mask | u32::from(is_other(primitive[lane])) << lane)
    }

    /// Fills lanes whose primitives are no triangles.
    pub(super) fn meet_shapes(
        &self,
        level: Level,
        (rays, hits): (&PathRays, &[Hit]),
        origin: &VectorLanes,
        lanes: u32,
        surfaces: &mut SurfaceBlock,
    ) {
        let mut spheres = Spheres { center: VectorLanes::ZERO, radius: [1.0; LANES], is_here: [false; LANES] };
        let mut any = false;
        for lane in (0..LANES).filter(|lane| lanes >> lane & 1 == 1) {
            match self.shape(surfaces.primitive[lane]).and_then(Shape::ball) {
                // A hit that is known may be on the far side: the ray has passed a mask on the near one.
                Some((center, radius)) if hits.is_empty() => {
                    spheres.center.set(lane, center);
                    (spheres.radius[lane], spheres.is_here[lane]) = (radius, true);
                    any = true;
                }
                _ => self.meet_other((rays, hits), lane, surfaces),
            }
        }
        if any {
            let SurfaceBlock { direction, position, origin: leaves, normal, cosine, is_front, .. } = surfaces;
            meet(level, &spheres, origin, direction, position, leaves, normal, cosine, is_front);
        }
    }

    /// Fills one lane.
    fn meet_other(&self, (rays, hits): (&PathRays, &[Hit]), lane: usize, surfaces: &mut SurfaceBlock) {
        let (ray, hit) = self.hit_of_lane((rays, hits), surfaces, lane);
        let point = self.surface(&ray, &hit);
        let slope = point.normal.dot(ray.direction);
        let normal: DVec3 = if slope < 0.0 { point.normal } else { -point.normal };
        surfaces.position.set(lane, point.position);
        surfaces.origin.set(lane, RayOrigin::off(point.position, point.error, normal).outside());
        surfaces.normal.set(lane, normal.as_vec3());
        (surfaces.cosine[lane], surfaces.is_front[lane]) = (slope.abs() as f32, mask(slope < 0.0));
    }

    /// The ray of a lane, with a direction of length 1, and its hit, which is looked up if there are hits of all rays.
    pub fn hit_of_lane(&self, (rays, hits): (&PathRays, &[Hit]), surfaces: &SurfaceBlock, lane: usize) -> (Ray, Hit) {
        let (i, primitive) = (surfaces.index[lane] as usize, surfaces.primitive[lane]);
        let (direction, time) = (rays.direction(i), rays.time(i));
        let length = direction.length();
        let ray = Ray { time, ..Ray::new(rays.origin(i), direction / length) };
        if let Some(hit) = hits.get(i) {
            return (ray, Hit { t: hit.t * length, ..*hit });
        }
        let mut hit = Hit { primitive, uv: surfaces.uv.map(|uv| uv[lane]), ..Hit::MISS };
        match self.shape(primitive) {
            Some(shape) => {
                shape.meet(&ray, &mut |met| {
                    (hit.t, hit.uv, hit.inner) = (met.t, met.uv, met.inner);
                    true
                });
            }
            None => hit.t = (surfaces.position.get(lane) - ray.origin).length(),
        }
        (ray, hit)
    }
}
