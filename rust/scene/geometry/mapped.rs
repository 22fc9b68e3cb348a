//! How a point lies in what textures know: coordinates, colours, and the space of its shape.

use super::Geometry;
use crate::math::{DVec3, Hit, Ray, Vec3};
use crate::optics::Rgb;
use crate::scene::textures::{Needs, TexturePoint};
use crate::scene::{ShadingPoint, SurfacePoint};

/// What textures and bumps may want to know of a hit. Only what is needed is right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mapped {
    /// Texture coordinates: of a mesh those of its vertices, or the weights of the second and third corner where it has
    /// none.
    pub uv: [f64; 2],
    /// How the point changes with them; zero where they do not tell points apart.
    pub dp: [DVec3; 2],
    /// How the unit shading normal does.
    pub dn: [DVec3; 2],
    /// How the point in the space of its shape does.
    pub object_dp: [DVec3; 2],
    /// The point in the space of its shape.
    pub position: DVec3,
    /// By how much lengths there differ from those of the world, about.
    pub scale: f64,
    /// The colour of the mesh's vertices.
    pub colour: Rgb,
    /// The shading normal in the space of its shape.
    pub shading_normal: DVec3,
}

impl Geometry {
    /// How a hit of a ray lies.
    ///
    /// # Panics
    /// If it is a miss.
    pub(super) fn mapped(&self, ray: &Ray, hit: &Hit, needs: Needs) -> Mapped {
        if let Some((instances, instance)) = self.instance(hit.primitive) {
            return instances.mapped(instance, ray, hit, needs);
        }
        let here = self.point(ray, hit);
        let mut mapped = Mapped {
            uv: here.point.uv,
            dp: here.point.dp,
            dn: here.point.dn,
            object_dp: here.point.dp,
            position: here.point.position,
            scale: 1.0,
            colour: Rgb::ONE,
            shading_normal: here.shading_normal,
        };
        if self.shape(hit.primitive).is_some() {
            return mapped;
        }
        let weights = [1.0 - hit.uv[0] - hit.uv[1], hit.uv[0], hit.uv[1]];
        if needs.colours
            && let Some(colours) = self.colours_of(hit.primitive)
        {
            mapped.colour = (0..3).map(|i| Vec3::from(colours[i]).as_dvec3() * weights[i]).sum();
        }
        if needs.uv
            && let Some(corners) = self.uvs_of(hit.primitive)
        {
            let corners = corners.map(|uv| uv.map(f64::from));
            mapped.uv = [0, 1].map(|k| (0..3).map(|i| corners[i][k] * weights[i]).sum());
            let [b, c] = [1, 2].map(|i| [corners[i][0] - corners[0][0], corners[i][1] - corners[0][1]]);
            // From changes with weights to changes with coordinates: by the inverse of a matrix of two rows.
            let determinant = b[0] * c[1] - b[1] * c[0];
            let per_uv = |by: [DVec3; 2]| {
                let both = [by[0] * c[1] - by[1] * b[1], by[1] * b[0] - by[0] * c[0]].map(|d| d / determinant);
                if both.iter().all(|d| d.is_finite()) { both } else { [DVec3::ZERO; 2] }
            };
            (mapped.dp, mapped.dn) = (per_uv(mapped.dp), per_uv(mapped.dn));
            mapped.object_dp = mapped.dp;
        }
        mapped
    }
}

impl ShadingPoint {
    /// What a hit of a ray needs, `width` being that of the footprint there.
    pub fn new(geometry: &Geometry, ray: &Ray, hit: &Hit, surface: &SurfacePoint, needs: Needs, width: f64) -> Self {
        let mut point = Self::plain(surface);
        point.is_front = surface.is_front(ray);
        if !needs.any() {
            return point;
        }
        let here = geometry.mapped(ray, hit, needs);
        point.texture = TexturePoint { uv: here.uv, position: here.position, colour: here.colour, ..point.texture };
        (point.dp, point.dn, point.object_dp) = (here.dp, here.dn, here.object_dp);
        if needs.width {
            // An ellipse on the surface whose short axis is the width; the mean of its axes is taken for its size.
            let cosine = ray.direction.dot(surface.normal).abs().max(1e-3);
            let size = width / cosine.sqrt();
            let area = point.dp[0].cross(point.dp[1]).length();
            point.texture.size = size * here.scale;
            point.texture.width = if area > 0.0 { size / area.sqrt() } else { 0.0 };
        }
        point
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::BruteForce;
    use crate::scene::textures::{Between, Checker, Domain, ProductTexture, UvTransform, Value, VertexColours};
    use crate::scene::{DiffuseMaterial, Instances, Matrix, Mesh, Prototype, Shape, Surface};
    use crate::simd::Level;
    use std::sync::Arc;

    const ALL: Needs = Needs { uv: true, colours: true, position: true, width: true, tangents: true };

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

    fn hit(uv: [f64; 2]) -> Hit {
        Hit { t: 0.0, uv, primitive: 0, inner: 0 }
    }

    #[test]
    fn tangents_are_what_differences_say_in_copies_too() {
        let place: Matrix = [[2.0, 0.5, 0.0, 7.0], [-1.0, 1.0, 0.3, 1.0], [0.0, 0.2, 1.5, -5.0]];
        // Nothing is kept of vertices that no material asks for.
        let checker = Between { a: 0.2.into(), b: 0.8.into(), pattern: Checker(Domain::Uv(UvTransform::default())) };
        let both = ProductTexture { a: Value::Texture(Arc::new(checker)), b: Value::Texture(Arc::new(VertexColours)) };
        let material = Arc::new(DiffuseMaterial { reflectance: Value::Texture(Arc::new(both)) });
        let prototype = Prototype::new(vec![Shape { surface: mesh().into(), material, ..Shape::default() }], |g| {
            BruteForce::over(g, Level::Scalar)
        });
        let instances = Instances::new(Arc::new(prototype.unwrap()), &[place]).unwrap();
        let ray = Ray::new(DVec3::ZERO, DVec3::Z);
        for geometry in [Geometry::new([Surface::from(mesh())]), Geometry::new([Surface::from(instances)])] {
            let at = |uv| {
                let point = geometry.point(&ray, &hit(uv));
                (geometry.mapped(&ray, &hit(uv), ALL), point.point.position, point.shading_normal)
            };
            let (here, position, normal) = at([0.2, 0.3]);
            for step in [[1e-4, 0.0], [0.0, 1e-4], [1e-4, -2e-4]] {
                let (there, moved, turned) = at([0.2 + step[0], 0.3 + step[1]]);
                let by = [there.uv[0] - here.uv[0], there.uv[1] - here.uv[1]];
                let told = here.dp[0] * by[0] + here.dp[1] * by[1];
                assert!((moved - position - told).length() < 1e-12, "{told}");
                let told = here.dn[0] * by[0] + here.dn[1] * by[1];
                assert!((turned - normal - told).length() < 1e-7, "{told}");
                let (there, told) = (there.position - here.position, here.object_dp);
                assert!((there - told[0] * by[0] - told[1] * by[1]).length() < 1e-12, "{there}");
            }
            assert!((here.colour - Rgb::new(0.5, 0.2, 0.3)).length() < 1e-15);
            assert!((here.uv[0] - (0.05 + 0.18 + 0.09)).abs() < 1e-7);
        }
    }

    #[test]
    fn coordinates_that_tell_no_points_apart_have_no_tangents() {
        let geometry = Geometry::new([Mesh { uvs: Some(vec![[0.5; 2]; 3]), ..mesh() }]);
        let here = geometry.mapped(&Ray::new(DVec3::ZERO, DVec3::Z), &hit([0.2, 0.3]), ALL);
        assert_eq!((here.uv, here.dp), ([0.5; 2], [DVec3::ZERO; 2]));
    }
}
