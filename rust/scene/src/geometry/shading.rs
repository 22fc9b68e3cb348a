//! Shading data of hits: derivatives, texture coordinates, colors and local position.

use super::Geometry;
use crate::textures::{Needs, TexturePoint};
use crate::{LookupContext, ShadingPoint, SurfacePoint};
use raywright_accel::Primitives;
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_optics::Rgb;

impl Geometry {
    /// Computes the shading data of a hit as seen from the front.
    ///
    /// # Panics
    /// If the ray misses.
    pub fn shading_point(&self, ray: &Ray, hit: &Hit, point: SurfacePoint, needs: Needs) -> ShadingPoint {
        if let Some((instances, instance)) = self.instance(hit.primitive) {
            return instances.shading_point(instance, ray, hit, point, needs);
        }
        let mut here = ShadingPoint::plain(point);
        if let Some(shape) = self.shape(hit.primitive) {
            let on_shape = shape.point(ray, hit.t, hit.uv);
            (here.dp, here.dn, here.object_dp) = (on_shape.dp, on_shape.dn, on_shape.dp);
            here.texture.uv = on_shape.uv;
            return here;
        }
        let [a, b, c] = self.corners(hit.primitive);
        (here.dp, here.dn) = ([b - a, c - a], self.turning(hit.primitive, hit.uv, point.shading_normal));
        here.texture = self.textured(hit, needs, here.texture);
        if needs.uv
            && let Some(corners) = self.uvs_of(hit.primitive)
        {
            // Derivatives by barycentric coordinates become derivatives by texture coordinates, by the inverse of a 2 ×
            // 2 matrix.
            let [b, c] = [1, 2].map(|i| [0, 1].map(|k| f64::from(corners[i][k]) - f64::from(corners[0][k])));
            let determinant = b[0] * c[1] - b[1] * c[0];
            let per_uv = |by: [DVec3; 2]| {
                let both = [by[0] * c[1] - by[1] * b[1], by[1] * b[0] - by[0] * c[0]].map(|d| d / determinant);
                if both.iter().all(|d| d.is_finite()) { both } else { [DVec3::ZERO; 2] }
            };
            (here.dp, here.dn) = (per_uv(here.dp), per_uv(here.dn));
        }
        here.object_dp = here.dp;
        here
    }

    /// Barycentric coordinates of the second and third corner at a point of a triangle's plane, clamped to the
    /// triangle.
    pub fn weights(&self, primitive: u32, at: DVec3) -> [f64; 2] {
        let [a, b, c] = self.corners(primitive);
        let (u, v, w) = (b - a, c - a, at - a);
        let normal = u.cross(v);
        let square = normal.length_squared();
        let [second, third] = [w.cross(v), u.cross(w)].map(|part| (part.dot(normal) / square).clamp(0.0, 1.0));
        let sum = (second + third).max(1.0);
        [second / sum, third / sum]
    }

    /// The texture lookup data of a triangle hit.
    fn textured(&self, hit: &Hit, needs: Needs, plain: TexturePoint) -> TexturePoint {
        let mut texture = TexturePoint { uv: hit.uv, ..plain };
        let weights = [1.0 - hit.uv[0] - hit.uv[1], hit.uv[0], hit.uv[1]];
        if needs.colours
            && let Some(colours) = self.colours_of(hit.primitive)
        {
            texture.colour = (0..3).map(|i| Rgb::from_array(colours[i].map(f64::from)) * weights[i]).sum();
        }
        if needs.uv
            && let Some(corners) = self.uvs_of(hit.primitive)
        {
            texture.uv = [0, 1].map(|k| (0..3).map(|i| f64::from(corners[i][k]) * weights[i]).sum());
        }
        texture
    }

    /// Derivatives of a triangle's shading normal by barycentric coordinates; the normal is `unit` there.
    fn turning(&self, primitive: u32, uv: [f64; 2], unit: DVec3) -> [DVec3; 2] {
        let Some([a, b, c]) = self.normals_of(primitive) else { return [DVec3::ZERO; 2] };
        let sum = a * (1.0 - uv[0] - uv[1]) + b * uv[0] + c * uv[1];
        // Negated if the shading normal was. Normalization removes the component along the normal.
        let length = sum.dot(unit);
        if length == 0.0 {
            return [DVec3::ZERO; 2];
        }
        [b - a, c - a].map(|change| (change - unit * change.dot(unit)) / length)
    }
}

impl ShadingPoint {
    /// Computes the shading data of a hit for a lookup context.
    pub fn new(
        geometry: &Geometry,
        ray: &Ray,
        hit: &Hit,
        point: SurfacePoint,
        needs: Needs,
        gaze: impl Into<LookupContext>,
    ) -> Self {
        let LookupContext { width, waves } = gaze.into();
        let mut here = Self::plain(point);
        if needs.of_place() {
            here = geometry.shading_point(ray, hit, point, needs);
        }
        here.is_front = point.is_front(ray);
        here.texture.waves = waves;
        if needs.width {
            // The footprint on the surface is an ellipse whose short axis is the width; its size is the geometric mean
            // of both axes.
            let cosine = ray.direction.dot(point.normal).abs().max(1e-3);
            let size = width / cosine.sqrt();
            let area = here.dp[0].cross(here.dp[1]).length();
            here.texture.size = size * here.scale;
            here.texture.width = if area > 0.0 { size / area.sqrt() } else { 0.0 };
        }
        here
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::textures::{Between, Checker, Domain, ProductTexture, UvTransform, Value, VertexColours};
    use crate::{DiffuseMaterial, Instances, Matrix, Mesh, Prototype, Shape, Surface};
    use raywright_accel::BruteForce;
    use raywright_base::math::Vec3;
    use raywright_base::simd::Level;
    use raywright_shapes::Sphere;
    use std::sync::Arc;

    const ALL: Needs = Needs { uv: true, colours: true, position: true, width: true, tangents: true, waves: false };

    fn mesh() -> Mesh {
        Mesh {
            vertices: vec![Vec3::new(1.0, 0.0, 0.5), Vec3::new(3.0, 1.0, 0.0), Vec3::new(0.0, 2.0, 1.0)].into(),
            faces: vec![[0, 1, 2]],
            normals: Some(vec![Vec3::Z, Vec3::new(0.3, 0.1, 1.0), Vec3::new(-0.2, 0.4, 1.0)]),
            uvs: Some(vec![[0.1, 0.2], [0.9, 0.1], [0.3, 0.8]]),
            colours: Some(vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
            ..Mesh::default()
        }
    }

    fn all(geometry: &Geometry, ray: &Ray, hit: &Hit, needs: Needs) -> ShadingPoint {
        geometry.shading_point(ray, hit, geometry.surface(ray, hit), needs)
    }

    fn hit(uv: [f64; 2]) -> Hit {
        Hit { t: 0.0, uv, primitive: 0, inner: 0 }
    }

    #[test]
    fn tangents_are_what_differences_say_in_copies_too() {
        let place: Matrix = [[2.0, 0.5, 0.0, 7.0], [-1.0, 1.0, 0.3, 1.0], [0.0, 0.2, 1.5, -5.0]];
        // Attributes of vertices that no material reads are dropped.
        let checker = Between { a: 0.2.into(), b: 0.8.into(), pattern: Checker(Domain::Uv(UvTransform::default())) };
        let both = ProductTexture { a: Value::Texture(Arc::new(checker)), b: Value::Texture(Arc::new(VertexColours)) };
        let material = Arc::new(DiffuseMaterial { reflectance: Value::Texture(Arc::new(both)) });
        let prototype = Prototype::new(vec![Shape { surface: mesh().into(), material, ..Shape::default() }], |g| {
            BruteForce::over(g, Level::Scalar)
        });
        let instances = Instances::new(Arc::new(prototype.unwrap()), &[place]).unwrap();
        let ray = Ray::new(DVec3::ZERO, DVec3::Z);
        for geometry in [Geometry::new([Surface::from(mesh())]), Geometry::new([Surface::from(instances)])] {
            let at = |uv| all(&geometry, &ray, &hit(uv), ALL);
            let here = at([0.2, 0.3]);
            for step in [[1e-4, 0.0], [0.0, 1e-4], [1e-4, -2e-4]] {
                let there = at([0.2 + step[0], 0.3 + step[1]]);
                let by = [0, 1].map(|k| there.texture.uv[k] - here.texture.uv[k]);
                let told = here.dp[0] * by[0] + here.dp[1] * by[1];
                assert!((there.point.position - here.point.position - told).length() < 1e-12, "{told}");
                let told = here.dn[0] * by[0] + here.dn[1] * by[1];
                let turned = there.point.shading_normal - here.point.shading_normal;
                assert!((turned - told).length() < 1e-7, "{told}");
                let (there, told) = (there.texture.position - here.texture.position, here.object_dp);
                assert!((there - told[0] * by[0] - told[1] * by[1]).length() < 1e-12, "{there}");
            }
            assert!((here.texture.colour - Rgb::new(0.5, 0.2, 0.3)).abs().max() < 1e-15);
            assert!((here.texture.uv[0] - (0.05 + 0.18 + 0.09)).abs() < 1e-7);
        }
    }

    #[test]
    fn coordinates_that_tell_no_points_apart_have_no_tangents() {
        let geometry = Geometry::new([Mesh { uvs: Some(vec![[0.5; 2]; 3]), ..mesh() }]);
        let here = all(&geometry, &Ray::new(DVec3::ZERO, DVec3::Z), &hit([0.2, 0.3]), ALL);
        assert_eq!((here.texture.uv, here.dp), ([0.5; 2], [DVec3::ZERO; 2]));
    }

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
            let at = |u: f64, v: f64| all(&geometry, &Ray::new(DVec3::ZERO, DVec3::Z), &hit([u, v]), Needs::NONE);
            let (here, h) = (at(0.3, 0.4), 1e-6);
            assert_eq!(here.point.normal, DVec3::Z * sign);
            assert!(here.point.shading_normal.dot(here.point.normal) > 0.0);
            let normal = |u: f64, v: f64| at(u, v).point.shading_normal;
            let difference = [
                (normal(0.3 + h, 0.4) - normal(0.3 - h, 0.4)) / (2.0 * h),
                (normal(0.3, 0.4 + h) - normal(0.3, 0.4 - h)) / (2.0 * h),
            ];
            for k in 0..2 {
                assert!((here.dn[k] - difference[k]).length() < 1e-9, "{:?}, not {difference:?}", here.dn);
                let step = if k == 0 { at(0.3 + 0.25, 0.4) } else { at(0.3, 0.4 + 0.25) };
                let moved = (step.point.position - here.point.position) / 0.25;
                assert!((here.dp[k] - moved).length() < 1e-12);
            }
        }
    }

    #[test]
    fn a_shape_among_meshes_tells_its_own() {
        let sphere: Arc<dyn raywright_shapes::Shape> = Arc::new(Sphere { center: DVec3::Y, radius: 2.0 });
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
        let here = all(&geometry, &ray, &hit, Needs::NONE);
        assert!((here.point.position - DVec3::new(0.0, 1.0, 2.0)).length() < 1e-15);
        assert!((here.point.normal - DVec3::Z).length() < 1e-15);
        assert_eq!(geometry.surface(&ray, &hit).shape, 1);
    }
}
