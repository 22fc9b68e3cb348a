//! Where the rays of a patch start.

use super::Enclosure;
use raywright_base::math::{DVec3, Frame, Ray};
use raywright_base::sampling::warp::{cosine_hemisphere, uniform_triangle};
use raywright_scene::{RayOrigin, Scene, SurfacePoint};

/// A point of a side of a patch.
pub(super) struct Origin {
    pub surface: SurfacePoint,
    /// 1 for the side of the normal, −1 for the other.
    pub side: f64,
    /// The face that rays leave.
    pub face: u32,
    /// The same if it is a triangle, which is flat and so does not see itself.
    pub triangle: u32,
}

impl Origin {
    /// Draws a point of a source, even by area; `None` if the draw gives none.
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

    /// Its face, the side of that, and where it is.
    #[inline]
    pub fn place(&self) -> (u32, f64, DVec3) {
        (self.face, self.side, self.surface.position)
    }

    /// The ray that leaves it into the direction that two numbers draw by the cosine.
    #[inline]
    pub fn leave(&self, u: [f64; 2]) -> Ray {
        let direction = Frame::new(self.surface.normal * self.side).to_world(cosine_hemisphere(u));
        self.past_itself(RayOrigin::new(&self.surface).ray(direction))
    }

    /// A ray from it, which need not be asked about what it leaves.
    #[inline]
    pub fn past_itself(&self, ray: Ray) -> Ray {
        Ray { misses: [self.triangle, Ray::NO_TRIANGLE], ..ray }
    }
}
