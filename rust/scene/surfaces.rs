//! What is in a scene and is no mesh, as accelerators see it.

use crate::accel::{Objects, Wanted};
use crate::math::Ray;
use crate::shapes::{Bounds, Candidate, Shape};
use std::sync::Arc;

/// Shapes by their numbers among all primitives, which increase.
#[derive(Clone, Debug, Default)]
pub struct Surfaces {
    numbers: Vec<u32>,
    shapes: Vec<Arc<dyn Shape>>,
}

impl Surfaces {
    /// Adds a shape, with a number greater than any before.
    pub fn push(&mut self, number: u32, shape: Arc<dyn Shape>) {
        debug_assert!(self.numbers.last().is_none_or(|&last| last < number));
        self.numbers.push(number);
        self.shapes.push(shape);
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }

    /// The least of the numbers.
    pub fn first(&self) -> u32 {
        self.numbers[0]
    }

    /// The shape of a number; none of a triangle.
    #[inline]
    pub fn get(&self, number: u32) -> Option<&dyn Shape> {
        self.numbers.binary_search(&number).ok().map(|i| self.shapes[i].as_ref())
    }

    /// Memory held, without that of the shapes themselves.
    pub fn bytes(&self) -> usize {
        size_of_val(self.numbers.as_slice()) + size_of_val(self.shapes.as_slice())
    }
}

impl Objects for Surfaces {
    fn bounds(&self, primitive: u32) -> Option<Bounds> {
        self.get(primitive).map(|shape| shape.bounds())
    }

    fn meet(&self, primitive: u32, _: Wanted, ray: &Ray, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
        self.get(primitive).is_some_and(|shape| shape.meet(ray, met))
    }
}
