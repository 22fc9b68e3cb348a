//! Primitives that are no triangles: curved shapes, and whole scenes put elsewhere.

use super::Primitives;
use super::query::Wanted;
use raywright_base::math::{DVec3, Ray};
use raywright_shapes::{Ball, Bounds, Candidate};

/// Others put elsewhere as they are.
pub struct Placed<'a> {
    /// Known by it: the same others have the same.
    pub id: usize,
    /// What they are.
    pub primitives: &'a dyn Primitives,
    /// Rows of the linear map that takes what is around to where they are, once `shift` is taken off.
    pub rows: [DVec3; 3],
    /// Where their origin stands.
    pub shift: DVec3,
}

/// What is hit and is no triangle, known by its number among all primitives.
pub trait UserGeometry: Send + Sync {
    /// The box around one, rounded outwards. None of what nothing can hit, triangles among it.
    fn bounds(&self, primitive: u32) -> Option<Bounds>;

    /// A ball around one that stands still.
    fn around(&self, primitive: u32) -> Option<Ball> {
        self.bounds(primitive).map(|bounds| bounds.around())
    }

    /// Whether hits tell of primitives within what is hit ([`raywright_base::math::Hit::inner`]).
    fn is_nested(&self) -> bool {
        false
    }

    /// Whether anything moves while the shutter is open.
    fn moves(&self) -> bool {
        false
    }

    /// The boxes around one at the times 0 and 1. Interpolated number by number, they hold it at any time between.
    fn ends(&self, primitive: u32) -> Option<[Bounds; 2]> {
        self.bounds(primitive).map(|b| [b, b])
    }

    /// Of one that is others put elsewhere, and stands still as they do: those.
    fn inside(&self, primitive: u32) -> Option<Placed<'_>> {
        let _ = primitive;
        None
    }

    /// Calls `met` with what of it the ray meets between `t_min` and `t_max`, both ends included, until it says true;
    /// then that is said. Nothing has to be told but what is wanted: the first, or any, or every point.
    fn meet(&self, primitive: u32, wanted: Wanted, ray: &Ray, met: &mut dyn FnMut(Candidate) -> bool) -> bool;
}
