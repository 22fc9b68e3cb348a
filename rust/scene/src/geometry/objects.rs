//! Shapes that are not meshes, and instances, in the form that accelerators use.

use super::instances::Instances;
use super::prototype::Prototype;
use raywright_accel::{Placed, UserGeometry, Wanted};
use raywright_base::math::{DVec3, Ray};
use raywright_shapes::{Ball, Bounds, Candidate, Shape};
use std::sync::Arc;

/// Shapes by their increasing primitive numbers.
#[derive(Clone, Debug, Default)]
pub struct Objects {
    numbers: Vec<u32>,
    shapes: Vec<Arc<dyn Shape>>,
    /// Instances, each with its first primitive number.
    instances: Vec<(u32, Instances)>,
}

impl Objects {
    /// Adds a shape, with a number greater than any before.
    pub fn push(&mut self, number: u32, shape: Arc<dyn Shape>) {
        debug_assert!(self.numbers.last().is_none_or(|&last| last < number));
        self.numbers.push(number);
        self.shapes.push(shape);
    }

    /// Adds instances of a prototype; the first primitive number is greater than any before.
    pub fn push_instances(&mut self, number: u32, instances: Instances) {
        self.instances.push((number, instances));
    }

    /// Returns whether there are no objects.
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty() && self.instances.is_empty()
    }

    /// Returns whether there are instances.
    pub fn has_instances(&self) -> bool {
        !self.instances.is_empty()
    }

    /// The instances of a primitive number, and its index among them; `None` if it is not an instance.
    #[inline]
    pub fn instance(&self, number: u32) -> Option<(&Instances, u32)> {
        let before = self.instances.partition_point(|&(first, _)| first <= number);
        let (first, instances) = &self.instances[before.checked_sub(1)?];
        let instance = number - first;
        ((instance as usize) < instances.count()).then_some((instances, instance))
    }

    /// The smallest primitive number.
    pub fn first(&self) -> Option<u32> {
        let instances = self.instances.first().map(|&(first, _)| first);
        self.numbers.first().copied().into_iter().chain(instances).min()
    }

    /// The shape of a primitive number; `None` for a triangle.
    #[inline]
    pub fn get(&self, number: u32) -> Option<&dyn Shape> {
        self.numbers.binary_search(&number).ok().map(|i| self.shapes[i].as_ref())
    }

    /// All primitive numbers.
    pub fn all(&self) -> impl Iterator<Item = u32> {
        let copies = self.instances.iter().flat_map(|(first, instances)| *first..first + instances.count() as u32);
        self.numbers.iter().copied().chain(copies)
    }

    /// Memory in bytes, excluding shapes themselves and prototypes in `seen`; prototypes found here are added to it.
    pub fn bytes(&self, seen: &mut Vec<*const Prototype>) -> usize {
        let of_copies = |(_, instances): &(u32, Instances)| instances.bytes() + instances.prototype().bytes(seen);
        size_of_val(self.numbers.as_slice())
            + size_of_val(self.shapes.as_slice())
            + size_of_val(self.instances.as_slice())
            + self.instances.iter().map(of_copies).sum::<usize>()
    }
}

impl UserGeometry for Objects {
    fn bounds(&self, primitive: u32) -> Option<Bounds> {
        match self.get(primitive) {
            Some(shape) => Some(shape.bounds()),
            None => self.instance(primitive).and_then(|(instances, instance)| instances.bounds(instance)),
        }
    }

    fn around(&self, primitive: u32) -> Option<Ball> {
        match self.get(primitive) {
            Some(shape) => Some(shape.around()),
            None => self.bounds(primitive).map(|bounds| bounds.around()),
        }
    }

    fn ball(&self, primitive: u32) -> Option<(DVec3, f64)> {
        self.get(primitive)?.ball()
    }

    fn is_nested(&self) -> bool {
        self.has_instances()
    }

    fn moves(&self) -> bool {
        self.instances.iter().any(|(_, instances)| instances.moves())
    }

    fn ends(&self, primitive: u32) -> Option<[Bounds; 2]> {
        match self.instance(primitive) {
            Some((instances, instance)) => instances.ends(instance),
            None => self.bounds(primitive).map(|b| [b, b]),
        }
    }

    fn inside(&self, primitive: u32) -> Option<Placed<'_>> {
        let (instances, instance) = self.instance(primitive)?;
        instances.inside(instance)
    }

    fn meet(&self, primitive: u32, wanted: Wanted, ray: &Ray, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
        match self.instance(primitive) {
            Some((instances, instance)) => instances.meet(instance, wanted, ray, met),
            None => self.get(primitive).is_some_and(|shape| {
                let mut answered = false;
                shape.meet(ray, &mut |candidate| {
                    answered = met(candidate);
                    // A shape reports its hits in order, so the first is the closest.
                    answered || matches!(wanted, Wanted::Closest)
                });
                answered
            }),
        }
    }
}
