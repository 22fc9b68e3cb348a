//! Origins of the rays from a patch.

use super::Enclosure;
use raywright_base::math::{DVec3, Frame, Ray};
use raywright_base::sampling::warp::{cosine_hemisphere, uniform_triangle};
use raywright_scene::{RayOrigin, Scene, SurfacePoint};

/// A point on a side of a patch.
pub(super) struct Origin {
    pub surface: SurfacePoint,
    /// 1 for the side of the normal, −1 for the other.
    pub side: f64,
    /// The face that rays leave.
    pub face: u32,
    /// The same if it is a triangle, which is flat and cannot see itself.
    pub triangle: u32,
}

impl Origin {
    /// Sample a point of a source uniformly by area; `None` if sampling fails.
    #[inline]
    pub fn draw(scene: &Scene, enclosure: &Enclosure, source: u32, u: [f64; 2]) -> Option<Self> {
        let (patch, side) = enclosure.side(source);
        let (geometry, cell) = (scene.geometry(), enclosure.patches.cell(patch));
        let Some(shape) = geometry.shape(cell.primitive) else {
            let surface = geometry.on_triangle(cell.primitive, cell.at(uniform_triangle(u)));
            return Some(Self { surface, side, face: cell.primitive, triangle: cell.primitive });
        };
        let drawn = shape.sample(u)?;
        let surface = geometry.on_shape(cell.primitive, &drawn.point.site());
        Some(Self { surface, side, face: cell.primitive, triangle: Ray::NO_TRIANGLE })
    }

    /// Its face, side and position.
    #[inline]
    pub fn place(&self) -> (u32, f64, DVec3) {
        (self.face, self.side, self.surface.position)
    }

    /// A ray in a cosine-weighted random direction.
    #[inline]
    pub fn leave(&self, u: [f64; 2]) -> Ray {
        let direction = Frame::new(self.surface.normal * self.side).to_world(cosine_hemisphere(u));
        self.past_itself(RayOrigin::new(&self.surface).ray(direction))
    }

    /// A ray from it that skips the triangle it leaves.
    #[inline]
    pub fn past_itself(&self, ray: Ray) -> Ray {
        Ray { misses: [self.triangle, Ray::NO_TRIANGLE], ..ray }
    }
}
