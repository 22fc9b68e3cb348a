//! Solids bounded by planes and quadrics, and their intersections with a line.

use super::Contact;
use super::line::{Carried, Line};
use raywright_base::math::{Bounded, DVec3, Number, Triple};

/// An intersection of a line with one of a solid's bounding surfaces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meet<N> {
    /// The line parameter.
    pub t: N,
    /// The derivative of [`Solid::surface`] along the line.
    pub slope: N,
    /// Half the second derivative; 0 for planes.
    pub bend: N,
    /// The index of the surface, numbered by the shape.
    pub surface: usize,
    /// The part of the shape that determines the surface parameters.
    pub part: usize,
    /// The contact; for closed shapes it is determined later.
    pub contact: Contact,
}

/// The intersections of a line with a solid, in any order.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meets<N> {
    /// The intersections; the first `count` are set.
    pub all: [Option<Meet<N>>; 4],
    /// Their number.
    pub count: usize,
    /// True if the first and the last bound a segment inside a closed convex shape. Intersections between them are then
    /// ignored.
    pub closed: bool,
}

impl<N> Meets<N> {
    /// An empty list.
    #[inline(always)]
    pub fn new(closed: bool) -> Self {
        Self { all: [const { None }; 4], count: 0, closed }
    }

    /// Append an intersection.
    #[inline(always)]
    pub fn with(mut self, meet: Meet<N>) -> Self {
        self.all[self.count] = Some(meet);
        self.count += 1;
        self
    }
}

/// A shape that computes line intersections in any number type.
pub(super) trait Solid {
    /// Compute the intersections, or None if the error bounds leave open whether or which part is hit. With exact
    /// numbers, duplicates are allowed if there are more than two.
    fn meets<N: Number>(&self, line: &Line<N>) -> Option<Meets<N>>;

    /// The same in f64 with error bounds. Shapes may override this with a faster method.
    #[inline(always)]
    fn meets_roughly(&self, ray: &Carried<'_>) -> Option<Meets<Bounded>> {
        self.meets(&ray.line::<Bounded>())
    }

    /// Evaluate the implicit polynomial of a surface, of degree 2 at most, at a point in units relative to
    /// [`Solid::reference`].
    fn surface<N: Number>(&self, surface: usize, point: &Triple<N>, unit: &N) -> N;

    /// The surface parameters of a point of a part, given to f64 precision relative to [`Solid::reference`].
    fn coordinates(&self, part: usize, point: DVec3) -> [f64; 2];

    /// A reference point on the shape. Other points are relative to it, which keeps digits far from the origin.
    fn reference(&self) -> DVec3;
}
