//! How a surface lies where a ray meets it.

use super::Geometry;
use crate::accel::Primitives;
use crate::math::{DVec3, Hit, Ray};
use crate::scene::HitPoint;
use crate::shapes::Point;

impl Geometry {
    /// All about a hit of a ray.
    ///
    /// # Panics
    /// If it is a miss.
    pub fn point(&self, ray: &Ray, hit: &Hit) -> HitPoint {
        if let Some((instances, instance)) = self.instance(hit.primitive) {
            return instances.point(instance, ray, hit);
        }
        if let Some(shape) = self.shape(hit.primitive) {
            let point = shape.point(ray, hit.t, hit.uv);
            return HitPoint { point, shading_normal: point.normal };
        }
        let [a, b, c] = self.corners(hit.primitive);
        let surface = self.on_triangle(hit.primitive, hit.uv);
        let (normal, shading_normal) = (surface.normal, surface.shading_normal);
        let dn = self.turning(hit.primitive, hit.uv, shading_normal);
        let (position, error) = (surface.position, surface.error);
        let point = Point { position, error, normal, uv: hit.uv, dp: [b - a, c - a], dn };
        HitPoint { point, shading_normal }
    }

    /// How the shading normal of a triangle, which is `unit` there, changes with either coordinate.
    fn turning(&self, primitive: u32, uv: [f64; 2], unit: DVec3) -> [DVec3; 2] {
        let Some([a, b, c]) = self.normals_of(primitive) else { return [DVec3::ZERO; 2] };
        let sum = a * (1.0 - uv[0] - uv[1]) + b * uv[0] + c * uv[1];
        // Turned round if the shading normal was. Of the change only what turns it is left when it is made unit.
        let length = sum.dot(unit);
        if length == 0.0 {
            return [DVec3::ZERO; 2];
        }
        [b - a, c - a].map(|change| (change - unit * change.dot(unit)) / length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::scene::{Mesh, Surface};
    use crate::shapes::{Shape, Sphere};
    use std::sync::Arc;

    #[test]
    fn normals_change_as_differences_say() {
        let normals = vec![Vec3::new(0.1, 0.2, 1.0), Vec3::new(0.5, -0.2, 0.7), Vec3::new(-0.3, 0.6, 2.0)];
        for (turned, sign) in [([0, 1, 2], 1.0), ([0, 2, 1], -1.0)] {
            let mesh = Mesh {
                vertices: vec![Vec3::ZERO, Vec3::X, Vec3::Y].into(),
                faces: vec![turned],
                normals: Some(normals.clone()),
                ..Mesh::default()
            };
            let geometry = Geometry::new([mesh]);
            let at = |u: f64, v: f64| {
                geometry.point(&Ray::new(DVec3::ZERO, DVec3::Z), &Hit { t: 0.0, uv: [u, v], primitive: 0, inner: 0 })
            };
            let (here, h) = (at(0.3, 0.4), 1e-6);
            assert_eq!(here.point.normal, DVec3::Z * sign);
            assert!(here.shading_normal.dot(here.point.normal) > 0.0);
            let difference = [
                (at(0.3 + h, 0.4).shading_normal - at(0.3 - h, 0.4).shading_normal) / (2.0 * h),
                (at(0.3, 0.4 + h).shading_normal - at(0.3, 0.4 - h).shading_normal) / (2.0 * h),
            ];
            for k in 0..2 {
                assert!((here.point.dn[k] - difference[k]).length() < 1e-9, "{:?}, not {difference:?}", here.point.dn);
                let step = if k == 0 { at(0.3 + 0.25, 0.4) } else { at(0.3, 0.4 + 0.25) };
                let moved = (step.point.position - here.point.position) / 0.25;
                assert!((here.point.dp[k] - moved).length() < 1e-12);
            }
        }
    }

    #[test]
    fn a_shape_among_meshes_tells_its_own() {
        let sphere: Arc<dyn Shape> = Arc::new(Sphere { center: DVec3::Y, radius: 2.0 });
        let mesh = Mesh {
            vertices: vec![Vec3::ZERO, Vec3::X, Vec3::Y].into(),
            faces: vec![[0, 1, 2]],
            normals: None,
            ..Mesh::default()
        };
        let geometry = Geometry::new([Surface::from(mesh.clone()), sphere.into(), mesh.into()]);
        assert_eq!((geometry.locate(0), geometry.locate(1), geometry.locate(2)), ((0, 0), (1, 0), (2, 0)));
        let ray = Ray::new(DVec3::new(0.0, 1.0, 5.0), -DVec3::Z);
        let mut uv = [0.0; 2];
        geometry.shape(1).unwrap().meet(&ray, &mut |met| {
            uv = met.uv;
            true
        });
        let hit = Hit { t: 3.0, uv, primitive: 1, inner: 0 };
        let here = geometry.point(&ray, &hit);
        assert!((here.point.position - DVec3::new(0.0, 1.0, 2.0)).length() < 1e-15);
        assert!((here.point.normal - DVec3::Z).length() < 1e-15);
        assert_eq!(geometry.surface(&ray, &hit).shape, 1);
    }
}
