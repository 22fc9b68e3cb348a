//! Origins of rays that leave a surface.

use super::SurfacePoint;
use raywright_base::math::{DVec3, Ray, select};

/// A point on a surface where rays start or end.
///
/// A ray must neither hit the surface it leaves, nor start behind another one close by. So its origin is offset from
/// the surface by just the bound on rounding errors, at any scale (Pharr, Jakob and Humphreys, "Physically Based
/// Rendering", 4th ed., 2023, 6.8.6), rather than by a fixed distance.
#[derive(Clone, Copy, Debug)]
pub struct RayOrigin {
    position: DVec3,
    /// Offset from the surface, on the side of its normal.
    offset: DVec3,
}

impl RayOrigin {
    /// Ratio of the offset to the position's error. With M the largest coordinate of the primitive, the position is
    /// within 8 ε M = 2⁻⁴⁹ M of its plane in each coordinate, at most 2⁻⁴⁸ M along the normal. The ray's own test
    /// computes the corners relative to its origin, up to 2 M long, and its distance from them by sums of products.
    /// These take at most 16 roundings of ε/2: another 2⁻⁴⁸ M. Twice the sum of both is 2⁻⁴⁶ M. On a sliver the
    /// products outweigh the distance, but there the test uses exact products if they could matter, and the offset is
    /// ample ([`raywright_shapes::triangle::EdgeRay`]).
    const SAFETY: f64 = 8.0;

    /// The least cosine that counts for [`RayOrigin::reach`].
    pub(super) const GRAZING: f64 = 1e-3;

    /// Where a segment ends, as a share of its way. What is left to the surface that it goes to is more than the error
    /// of that surface's test in f64, whose bounds are within 2⁻⁴⁶ of the way except where it is grazed. So most shapes
    /// can tell without longer numbers that they do not shadow themselves.
    pub const END: f64 = 1.0 - 1.0 / (1u64 << 45) as f64;

    /// The origin of rays from a surface point.
    #[inline(always)]
    pub fn new(surface: &SurfacePoint) -> Self {
        Self::off(surface.position, surface.error, surface.normal)
    }

    /// The origin of rays from a point with this normal, where each coordinate has at most this error.
    #[inline(always)]
    pub fn off(position: DVec3, error: f64, normal: DVec3) -> Self {
        Self { position, offset: normal * (Self::SAFETY * error) }
    }

    /// A point with a given offset.
    #[inline(always)]
    pub(super) fn with(position: DVec3, offset: DVec3) -> Self {
        Self { position, offset }
    }

    /// Offset from the surface.
    #[inline(always)]
    pub(super) fn offset(&self) -> DVec3 {
        self.offset
    }

    /// Radius around a hit, in lengths of the ray's direction, within which surfaces count as one with the hit surface.
    /// Rays that leave it start beyond them.
    #[inline]
    pub fn reach(surface: &SurfacePoint, ray: &Ray) -> f64 {
        // The offset along the normal, projected onto the ray; bounded for grazing rays.
        let slope = ray.direction.dot(surface.normal).abs().max(Self::GRAZING * ray.direction.length());
        Self::SAFETY * surface.error / slope
    }

    /// The surface point itself.
    #[inline(always)]
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// A point in free space.
    #[inline(always)]
    pub const fn free(position: DVec3) -> Self {
        Self { position, offset: DVec3::ZERO }
    }

    /// The start or end of a ray with this `direction` away from the surface.
    #[inline(always)]
    fn towards(&self, direction: DVec3) -> DVec3 {
        let offset = select(self.offset.dot(direction) < 0.0, -self.offset, self.offset);
        self.position + offset
    }

    /// Origin of rays that leave on the side of the normal.
    #[inline(always)]
    pub(super) fn outside(&self) -> DVec3 {
        self.position + self.offset
    }

    /// The ray that leaves in a direction.
    #[inline(always)]
    pub fn ray(&self, direction: DVec3) -> Ray {
        Ray::new(self.towards(direction), direction)
    }

    /// The segment to another point, for visibility tests.
    #[inline(always)]
    pub fn segment(&self, there: &Self) -> Ray {
        let direction = there.position - self.position;
        Ray { t_max: Self::END, ..Ray::segment(self.towards(direction), there.towards(-direction)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::scene;
    use crate::{Geometry, Mesh, SceneDescription, Shape, Vertices};
    use raywright_base::math::Vec3;
    use raywright_base::sampling::{Sampler, warp};

    /// A triangle with this size and position, randomly rotated.
    fn triangle(size: f64, place: f64, sample: u32) -> Mesh {
        let mut sampler = Sampler::new(1, 0, sample);
        let place = warp::uniform_sphere(sampler.two(0)) * place;
        let vertices = (1..4).map(|d| (place + warp::uniform_sphere(sampler.two(d)) * size).as_vec3()).collect();
        Mesh { vertices, faces: vec![[0, 1, 2]], normals: None, ..Mesh::default() }
    }

    #[test]
    fn no_ray_hits_the_triangle_it_leaves() {
        for (size, place) in [(1.0, 0.0), (1.0, 10.0), (1e-6, 0.0), (1e6, 1e7), (1e-3, 1e3), (1.0, 1e6)] {
            for sample in 0..200 {
                let mesh = triangle(size, place, sample);
                let description = SceneDescription {
                    shapes: vec![Shape { surface: mesh.into(), ..Shape::default() }],
                    ..Default::default()
                };
                let scene = scene(description);
                if scene.geometry().area_vector(0).length() < 0.01 * size * size {
                    continue;
                }
                let mut rays = Vec::new();
                for draw in 0..100 {
                    let mut sampler = Sampler::new(2, sample, draw);
                    let uv = warp::uniform_triangle(sampler.two(0));
                    let surface = scene.geometry().on_triangle(0, uv);
                    // Half of the rays graze the plane, down to an angle of 10⁻¹².
                    let direction = warp::uniform_sphere(sampler.two(1));
                    let departure = RayOrigin::new(&surface);
                    if draw % 2 == 0 {
                        let sine = 10f64.powf(-12.0 * sampler.one(2));
                        let along = direction.cross(surface.normal).normalize();
                        rays.push(departure.ray(along + surface.normal * sine));
                    } else {
                        rays.push(departure.ray(direction));
                        rays.push(departure.segment(&RayOrigin::free(surface.position + direction * size)));
                    }
                }
                let mut occluded = vec![false; rays.len()];
                scene.occluded(&rays, &mut occluded);
                assert!(!occluded.contains(&true), "size {size} at {place}");
            }
        }
    }

    #[test]
    fn no_ray_hits_the_sliver_it_leaves() {
        for sample in 0..600 {
            let (aspect, place) = ([10.0, 1e3, 1e6, 1e8][sample as usize % 4], [0.0, 1.0, 1e4][sample as usize % 3]);
            let mut sampler = Sampler::new(5, 0, sample);
            let [start, along, across] = [0, 1, 2].map(|d| warp::uniform_sphere(sampler.two(d)));
            let (start, across) = (start * place, across.reject_from(along) / aspect);
            let vertices = Vertices::Double(vec![start, start + along, start + 0.3 * along + across]);
            // Also in a large scene, which has larger error bounds.
            let far = if sample % 2 == 0 { 0.0 } else { 1e3 };
            let other = Mesh { faces: vec![[0, 0, 0]], ..triangle(1.0, far, sample) };
            let shapes = [Mesh { vertices, faces: vec![[0, 1, 2]], ..Mesh::default() }, other];
            let shapes = shapes.map(|mesh| Shape { surface: mesh.into(), ..Shape::default() }).into();
            let scene = scene(SceneDescription { shapes, ..Default::default() });
            let mut rays = Vec::new();
            for draw in 0..200 {
                let mut sampler = Sampler::new(6, sample, draw);
                let surface = scene.geometry().on_triangle(0, warp::uniform_triangle(sampler.two(0)));
                let direction = warp::uniform_sphere(sampler.two(1));
                // The normal is accurate to the aspect ratio times a rounding; a flatter direction has no defined side.
                if direction.dot(surface.normal).abs() > 64.0 * f64::EPSILON * aspect * (1.0 + place) {
                    rays.push(RayOrigin::new(&surface).ray(direction));
                }
            }
            let mut occluded = vec![false; rays.len()];
            scene.occluded(&rays, &mut occluded);
            assert_eq!(occluded.iter().filter(|&&o| o).count(), 0, "aspect {aspect} at {place}");
        }
    }

    #[test]
    fn starts_on_the_side_it_leaves_to_and_very_near() {
        let mesh = Mesh {
            vertices: vec![Vec3::new(0.0, 0.0, 3.0), Vec3::new(1.0, 0.0, 3.0), Vec3::new(0.0, 1.0, 3.0)].into(),
            faces: vec![[0, 1, 2]],
            normals: None,
            ..Mesh::default()
        };
        let surface = Geometry::new([mesh]).on_triangle(0, [0.25, 0.25]);
        let departure = RayOrigin::new(&surface);
        for (direction, sign) in [(DVec3::Z, 1.0), (DVec3::NEG_Z, -1.0)] {
            let height = sign * (departure.ray(direction).origin.z - 3.0);
            assert!(height > 0.0 && height < 1e-13);
        }
    }

    #[test]
    fn a_segment_stops_short_of_the_surface_it_goes_to() {
        let floor = Mesh {
            vertices: vec![Vec3::ZERO, Vec3::X, Vec3::Y].into(),
            faces: vec![[0, 1, 2]],
            normals: None,
            ..Mesh::default()
        };
        let ceiling = Mesh {
            vertices: vec![Vec3::Z, Vec3::Z + Vec3::Y, Vec3::Z + Vec3::X].into(),
            faces: vec![[0, 1, 2]],
            normals: None,
            ..Mesh::default()
        };
        let shapes = [floor, ceiling].map(|mesh| Shape { surface: mesh.into(), ..Shape::default() }).into();
        let scene = scene(SceneDescription { shapes, ..Default::default() });
        for sample in 0..1000 {
            let mut sampler = Sampler::new(4, 0, sample);
            let [a, b] = [0, 1].map(|primitive| {
                let uv = warp::uniform_triangle(sampler.two(primitive));
                RayOrigin::new(&scene.geometry().on_triangle(primitive, uv))
            });
            let mut occluded = [false; 2];
            scene.occluded(&[a.segment(&b), b.segment(&a)], &mut occluded);
            assert_eq!(occluded, [false; 2]);
        }
    }
}
