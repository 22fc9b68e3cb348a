//! What is in a scene and is no mesh, as accelerators see it: shapes, and copies of groups.

use super::copies::Copies;
use super::group::Group;
use crate::accel::{Objects, Wanted};
use crate::math::Ray;
use crate::shapes::{Bounds, Candidate, Shape};
use std::sync::Arc;

/// Shapes by their numbers among all primitives, which increase.
#[derive(Clone, Debug, Default)]
pub struct Surfaces {
    numbers: Vec<u32>,
    shapes: Vec<Arc<dyn Shape>>,
    /// With the number of the first of each.
    copies: Vec<(u32, Copies)>,
}

impl Surfaces {
    /// Adds a shape, with a number greater than any before.
    pub fn push(&mut self, number: u32, shape: Arc<dyn Shape>) {
        debug_assert!(self.numbers.last().is_none_or(|&last| last < number));
        self.numbers.push(number);
        self.shapes.push(shape);
    }

    /// Adds copies of a group, the first with a number greater than any before.
    pub fn push_copies(&mut self, number: u32, copies: Copies) {
        self.copies.push((number, copies));
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty() && self.copies.is_empty()
    }

    /// Whether there are copies among them.
    pub fn has_copies(&self) -> bool {
        !self.copies.is_empty()
    }

    /// Which copy of what a number is; none for what is no copy.
    #[inline]
    pub fn copy(&self, number: u32) -> Option<(&Copies, u32)> {
        let before = self.copies.partition_point(|&(first, _)| first <= number);
        let (first, copies) = &self.copies[before.checked_sub(1)?];
        let copy = number - first;
        ((copy as usize) < copies.count()).then_some((copies, copy))
    }

    /// The least of the numbers.
    pub fn first(&self) -> Option<u32> {
        let copies = self.copies.first().map(|&(first, _)| first);
        self.numbers.first().copied().into_iter().chain(copies).min()
    }

    /// The shape of a number; none for a triangle.
    #[inline]
    pub fn get(&self, number: u32) -> Option<&dyn Shape> {
        self.numbers.binary_search(&number).ok().map(|i| self.shapes[i].as_ref())
    }

    /// Memory held, without that of shapes themselves, and without groups that were `seen`; those here count as seen
    /// from then on.
    pub fn bytes(&self, seen: &mut Vec<*const Group>) -> usize {
        let of_copies = |(_, copies): &(u32, Copies)| copies.bytes() + copies.group().bytes(seen);
        size_of_val(self.numbers.as_slice())
            + size_of_val(self.shapes.as_slice())
            + size_of_val(self.copies.as_slice())
            + self.copies.iter().map(of_copies).sum::<usize>()
    }
}

impl Objects for Surfaces {
    fn bounds(&self, primitive: u32) -> Option<Bounds> {
        match self.get(primitive) {
            Some(shape) => Some(shape.bounds()),
            None => self.copy(primitive).and_then(|(copies, copy)| copies.bounds(copy)),
        }
    }

    fn moves(&self) -> bool {
        self.copies.iter().any(|(_, copies)| copies.moves())
    }

    fn ends(&self, primitive: u32) -> Option<[Bounds; 2]> {
        match self.copy(primitive) {
            Some((copies, copy)) => copies.ends(copy),
            None => self.bounds(primitive).map(|b| [b, b]),
        }
    }

    fn meet(&self, primitive: u32, wanted: Wanted, ray: &Ray, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
        match self.copy(primitive) {
            Some((copies, copy)) => copies.meet(copy, wanted, ray, met),
            None => self.get(primitive).is_some_and(|shape| {
                let mut answered = false;
                shape.meet(ray, &mut |candidate| {
                    answered = met(candidate);
                    // Of one shape the first that is told is the closest: the others need not be computed.
                    answered || matches!(wanted, Wanted::Closest)
                });
                answered
            }),
        }
    }
}
