//! Motion of surface points while the shutter is open.

use super::Geometry;
use crate::SurfacePoint;
use raywright_base::math::{DVec3, Hit, Ray};

impl Geometry {
    /// Positions of the hit surface point at two scene times.
    ///
    /// # Panics
    /// If it is a miss.
    pub fn positions(&self, ray: &Ray, hit: &Hit, times: [f64; 2]) -> [DVec3; 2] {
        if !self.moves() {
            return [self.surface(ray, hit).position; 2];
        }
        self.points(ray, hit, times).map(|point| point.position)
    }

    /// The full surface points at two scene times.
    fn points(&self, ray: &Ray, hit: &Hit, times: [f64; 2]) -> [SurfacePoint; 2] {
        let Some((instances, instance)) = self.instance(hit.primitive) else { return [self.surface(ray, hit); 2] };
        let prototype = instances.prototype();
        let pose = |time| instances.pose(instance, time);
        let Some(now) = pose(ray.time) else { return [self.surface(ray, hit); 2] };
        let (primitive, inner) = prototype.split(hit.inner);
        let within = prototype.geometry().points(&now.enter(ray), &Hit { primitive, inner, ..*hit }, times);
        let outside = |time: f64, point: &SurfacePoint| pose(time).map(|pose| pose.point(point));
        match (outside(times[0], &within[0]), outside(times[1], &within[1])) {
            (Some(start), Some(end)) => [start, end],
            _ => [self.surface(ray, hit); 2],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{rectangle, shape};
    use crate::{Instances, Matrix, Prototype, Shape};
    use raywright_accel::BruteForce;
    use raywright_base::simd::Level;
    use std::sync::Arc;

    #[test]
    fn points_go_where_their_copies_take_them() {
        let sheet = shape(rectangle([-1.0, -1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]), [0.5; 3], 0.0);
        let prototype = |shapes| Arc::new(Prototype::new(shapes, |g| BruteForce::over(g, Level::Scalar)).unwrap());
        let still: Matrix = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        // Twice as large and translated at shutter close; all of that translated once more.
        let grown: Matrix = [[2.0, 0.0, 0.0, 0.5], [0.0, 2.0, 0.0, 0.0], [0.0, 0.0, 2.0, 0.25]];
        let moved: Matrix = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 3.0], [0.0, 0.0, 1.0, 0.0]];
        let inner = Instances::moving(prototype(vec![sheet]), vec![[still, grown]]).unwrap();
        let inner = prototype(vec![Shape { surface: inner.into(), ..Shape::default() }]);
        let geometry = Geometry::new([crate::Surface::from(Instances::moving(inner, vec![[still, moved]]).unwrap())]);
        let ray = Ray::new(DVec3::new(0.25, -0.5, 5.0), DVec3::NEG_Z);
        let hit = BruteForce::over(&geometry, Level::Scalar).intersect_one(&ray);
        let way = |from, to| {
            let [start, end] = geometry.positions(&ray, &hit, [from, to]);
            end - start
        };
        let whole = way(0.0, 1.0);
        assert!((whole - DVec3::new(0.75, 2.5, 0.25)).length() < 1e-12, "{whole}");
        // Matrices are interpolated linearly, so a point moves on a straight line at constant speed.
        assert!((way(0.5, 1.0) - whole / 2.0).length() < 1e-12);
        assert_eq!(way(0.25, 0.25), DVec3::ZERO);
    }
}
