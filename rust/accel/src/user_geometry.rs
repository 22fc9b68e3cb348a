//! Primitives other than triangles: curved shapes and instances of scenes.

use super::Primitives;
use super::query::Wanted;
use raywright_base::math::{DVec3, Ray};
use raywright_shapes::{Ball, Bounds, Candidate};

/// An instance of other primitives.
pub struct Placed<'a> {
    /// Identifies the shared primitives.
    pub id: usize,
    /// The primitives of the prototype.
    pub primitives: &'a dyn Primitives,
    /// Rows of the linear map from the surrounding space to the prototype's, after subtracting `shift`.
    pub rows: [DVec3; 3],
    /// The position of the prototype's origin.
    pub shift: DVec3,
}

/// Primitives other than triangles, identified by their numbers among all primitives.
pub trait UserGeometry: Send + Sync {
    /// The bounding box of a primitive, rounded outward. None if it cannot be hit or is a triangle.
    fn bounds(&self, primitive: u32) -> Option<Bounds>;

    /// A bounding sphere of a primitive that does not move.
    fn around(&self, primitive: u32) -> Option<Ball> {
        self.bounds(primitive).map(|bounds| bounds.around())
    }

    /// Center and radius of a primitive that is a sphere and does not move.
    fn ball(&self, primitive: u32) -> Option<(DVec3, f64)> {
        let _ = primitive;
        None
    }

    /// Return whether hits identify primitives within the hit primitive ([`raywright_base::math::Hit::inner`]).
    fn is_nested(&self) -> bool {
        false
    }

    /// Return whether anything moves while the shutter is open.
    fn moves(&self) -> bool {
        false
    }

    /// The boxes at the times 0 and 1. Linear interpolation of their coordinates bounds the primitive at any time
    /// between.
    fn ends(&self, primitive: u32) -> Option<[Bounds; 2]> {
        self.bounds(primitive).map(|b| [b, b])
    }

    /// The instanced primitives of a static instance of static primitives.
    fn inside(&self, primitive: u32) -> Option<Placed<'_>> {
        let _ = primitive;
        None
    }

    /// Call `met` with the intersections between `t_min` and `t_max`, inclusive, until it returns true. Return whether
    /// it did. Only the wanted intersections need to be reported: the first, any one, or all.
    fn meet(&self, primitive: u32, wanted: Wanted, ray: &Ray, met: &mut dyn FnMut(Candidate) -> bool) -> bool;
}
