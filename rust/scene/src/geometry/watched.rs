//! Geometry during an interruptible build.

use super::Geometry;
use raywright_accel::{Primitives, UserGeometry};
use raywright_base::math::{DVec3, Region};
use raywright_base::work::Work;
use raywright_shapes::Bounds;
use std::sync::Arc;

/// A geometry, and the interruptible work over it.
#[derive(Clone, Copy)]
pub(crate) struct Watched<'a> {
    pub geometry: &'a Geometry,
    pub work: Work<'a>,
}

impl Primitives for Watched<'_> {
    fn count(&self) -> usize {
        self.geometry.count()
    }

    #[inline]
    fn corners(&self, primitive: u32) -> [DVec3; 3] {
        self.geometry.corners(primitive)
    }

    fn is_single(&self) -> bool {
        self.geometry.is_single()
    }

    fn objects(&self) -> Option<Arc<dyn UserGeometry>> {
        self.geometry.objects()
    }

    fn work(&self) -> Work<'_> {
        self.work
    }

    fn bounds(&self, primitive: u32) -> Option<Bounds> {
        self.geometry.bounds(primitive)
    }

    fn region(&self) -> Region {
        self.geometry.region()
    }
}
