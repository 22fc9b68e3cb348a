//! Where a point of a surface goes while the shutter is open.

use super::Geometry;
use crate::math::{DVec3, Hit, Ray};
use crate::scene::SurfacePoint;

impl Geometry {
    /// How far the point of a surface that a ray hits goes from the shutter's opening to its closing.
    ///
    /// # Panics
    /// If it is a miss.
    pub fn motion(&self, ray: &Ray, hit: &Hit) -> DVec3 {
        if !self.moves() {
            return DVec3::ZERO;
        }
        let [start, end] = self.ends(ray, hit);
        end.position - start.position
    }

    /// The point as the shutter opens and as it closes.
    fn ends(&self, ray: &Ray, hit: &Hit) -> [SurfacePoint; 2] {
        let Some((instances, instance)) = self.instance(hit.primitive) else { return [self.surface(ray, hit); 2] };
        let prototype = instances.prototype();
        let pose = |time| instances.pose(instance, time);
        let Some(now) = pose(ray.time) else { return [self.surface(ray, hit); 2] };
        let (primitive, inner) = prototype.split(hit.inner);
        let within = prototype.geometry().ends(&now.enter(ray), &Hit { primitive, inner, ..*hit });
        let outside = |time: f64, point: &SurfacePoint| pose(time).and_then(|pose| pose.point(point));
        match (outside(0.0, &within[0]), outside(1.0, &within[1])) {
            (Some(start), Some(end)) => [start, end],
            _ => [self.surface(ray, hit); 2],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::BruteForce;
    use crate::scene::fixtures::{rectangle, shape};
    use crate::scene::{Instances, Matrix, Prototype, Shape};
    use crate::simd::Level;
    use std::sync::Arc;

    #[test]
    fn points_go_where_their_copies_take_them() {
        let sheet = shape(rectangle([-1.0, -1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]), [0.5; 3], 0.0);
        let prototype = |shapes| Arc::new(Prototype::new(shapes, |g| BruteForce::over(g, Level::Scalar)).unwrap());
        let still: Matrix = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        // Twice as large at the end, and moved; and all of that moved once more.
        let grown: Matrix = [[2.0, 0.0, 0.0, 0.5], [0.0, 2.0, 0.0, 0.0], [0.0, 0.0, 2.0, 0.25]];
        let moved: Matrix = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 3.0], [0.0, 0.0, 1.0, 0.0]];
        let inner = Instances::moving(prototype(vec![sheet]), vec![[still, grown]]).unwrap();
        let inner = prototype(vec![Shape { surface: inner.into(), ..Shape::default() }]);
        let geometry =
            Geometry::new([crate::scene::Surface::from(Instances::moving(inner, vec![[still, moved]]).unwrap())]);
        let ray = Ray::new(DVec3::new(0.25, -0.5, 5.0), DVec3::NEG_Z);
        let hit = BruteForce::over(&geometry, Level::Scalar).intersect_one(&ray);
        let motion = geometry.motion(&ray, &hit);
        assert!((motion - DVec3::new(0.75, 2.5, 0.25)).length() < 1e-12, "{motion}");
    }
}
