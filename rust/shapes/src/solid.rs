//! A shape that is bounded by planes and quadrics, and where a line meets it.

use super::Contact;
use super::line::{Carried, Line};
use raywright_base::math::{Bounded, DVec3, Number, Triple};

/// Where a line meets one of the surfaces that bound a shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meet<N> {
    /// Along the line.
    pub t: N,
    /// The derivative by `t`, there, of what [`Solid::surface`] is along the line.
    pub slope: N,
    /// Half of the second derivative; 0 for a plane.
    pub bend: N,
    /// Which surface, counted as the shape likes.
    pub surface: usize,
    /// Which part of the shape it counts as, for its coordinates.
    pub part: usize,
    /// How; of a closed shape that is found out later.
    pub contact: Contact,
}

/// All of them, in any order.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meets<N> {
    /// The first so many are there.
    pub all: [Option<Meet<N>>; 4],
    /// How many.
    pub count: usize,
    /// Whether the first and the last are the ends of a segment within a closed convex shape; the others do not count
    /// then.
    pub closed: bool,
}

impl<N> Meets<N> {
    /// None yet.
    #[inline(always)]
    pub fn new(closed: bool) -> Self {
        Self { all: [const { None }; 4], count: 0, closed }
    }

    /// One more.
    #[inline(always)]
    pub fn with(mut self, meet: Meet<N>) -> Self {
        self.all[self.count] = Some(meet);
        self.count += 1;
        self
    }
}

/// A shape that can tell in any numbers where a line meets it.
pub(super) trait Solid {
    /// Where, or none where the numbers' errors leave open whether it is met, or by which part. Where there are many,
    /// some may be told twice, in numbers without error.
    fn meets<N: Number>(&self, line: &Line<N>) -> Option<Meets<N>>;

    /// The same with the bounds of an f64, for shapes that know a shorter way.
    #[inline(always)]
    fn meets_roughly(&self, ray: &Carried<'_>) -> Option<Meets<Bounded>> {
        self.meets(&ray.line::<Bounded>())
    }

    /// What is zero on one of its surfaces: a polynomial of second degree at most of a point, which is given in units,
    /// relative to [`Solid::reference`].
    fn surface<N: Number>(&self, surface: usize, point: &Triple<N>, unit: &N) -> N;

    /// The coordinates of a point of a part, given as nearly as f64 can relative to [`Solid::reference`].
    fn coordinates(&self, part: usize, point: DVec3) -> [f64; 2];

    /// A point of the shape that others are told relative to, so that far from the origin digits are kept.
    fn reference(&self) -> DVec3;
}
