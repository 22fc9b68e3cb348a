//! Ray queries, one type each: traversal is generic over the query, so each has its own kernels.

use super::{Boxes, ByColumns, Cost, Info, Nearest, PrimitiveFilter, Primitives, Touches};
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_shapes::triangle::{Along, SolidCone};
use raywright_shapes::{Candidate, Contact};

/// The intersections that a query needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// The closest intersection.
    Closest,
    /// True if there is any intersection.
    Any,
    /// All intersections, with points shared by triangles counted once.
    Every,
    /// All intersections of every triangle; the caller filters them.
    Met,
    /// The side of a closed surface on which the ray starts. This needs the parity of its crossings, and whether the
    /// ray starts on the surface, where `t` is 0.
    Side,
}

/// A ray query. Kernels offer it the triangles that a ray hits, in any order.
pub trait Query {
    /// The state of a ray.
    type State: Copy;

    /// The intersections to offer.
    const WANTED: Wanted;

    /// True if traversal should go nearest first.
    const NEAREST_FIRST: bool = matches!(Self::WANTED, Wanted::Closest);

    /// The intersections to offer; one type may hold queries of several kinds.
    #[inline(always)]
    fn wanted(&self) -> Wanted {
        Self::WANTED
    }

    /// The initial state of ray `i` for `t` up to `t_max` along its scaled direction.
    fn start(&self, i: usize, t_max: f64) -> Self::State;
    /// The greatest `t` that is still relevant.
    fn limit(state: &Self::State) -> f64;
    /// Offer an intersection. Return true if the query is done.
    fn offer(&mut self, state: &mut Self::State, primitive: u32, candidate: Candidate) -> bool;
    /// Store the result of ray `i`; without a state, that of a ray that cannot hit anything.
    fn finish(&mut self, i: usize, answer: Option<(Along, Self::State)>);

    /// True if visited nodes and primitives are counted. Such rays are traced one by one, so that the cost of each is
    /// its own.
    const COUNTED: bool = false;

    /// Count a node about to be tested.
    #[inline(always)]
    fn visit_node(state: &mut Self::State) {
        Self::visit_nodes(state, 1);
    }
    /// Count tested nodes.
    #[inline(always)]
    fn visit_nodes(_: &mut Self::State, _: u32) {}
    /// Count primitives about to be tested.
    #[inline(always)]
    fn visit_leaf(_: &mut Self::State, _: u32) {}
}

/// The closest hit.
pub struct ClosestQuery<'a>(pub &'a mut [Hit]);

impl Query for ClosestQuery<'_> {
    type State = Hit;
    const WANTED: Wanted = Wanted::Closest;

    #[inline(always)]
    fn start(&self, _: usize, t_max: f64) -> Hit {
        // Just beyond t_max, so that a hit at t_max itself is still closer.
        Hit { t: t_max.next_up(), ..Hit::MISS }
    }
    #[inline(always)]
    fn limit(state: &Hit) -> f64 {
        state.t
    }
    #[inline(always)]
    fn offer(&mut self, best: &mut Hit, primitive: u32, Candidate { t, uv, inner, .. }: Candidate) -> bool {
        if t < best.t || (t == best.t && primitive < best.primitive) {
            *best = Hit { t, uv, primitive, inner };
        }
        false
    }
    #[inline(always)]
    fn finish(&mut self, i: usize, answer: Option<(Along, Hit)>) {
        self.0[i] = match answer {
            Some((ray, hit)) if hit.is_hit() => Hit { t: hit.t * ray.scale, ..hit },
            _ => Hit::MISS,
        };
    }
}

/// True if there is any hit.
pub struct Any<'a>(pub &'a mut [bool]);

impl Query for Any<'_> {
    type State = (bool, f64);
    const WANTED: Wanted = Wanted::Any;

    #[inline(always)]
    fn start(&self, _: usize, t_max: f64) -> (bool, f64) {
        (false, t_max)
    }
    #[inline(always)]
    fn limit(state: &(bool, f64)) -> f64 {
        state.1
    }
    #[inline(always)]
    fn offer(&mut self, state: &mut (bool, f64), _: u32, _: Candidate) -> bool {
        state.0 = true;
        true
    }
    #[inline(always)]
    fn finish(&mut self, i: usize, answer: Option<(Along, (bool, f64))>) {
        self.0[i] = answer.is_some_and(|(_, (hit, _))| hit);
    }
}

/// An intersection with a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Meeting {
    /// The hit; `t` is along the scaled direction.
    pub hit: Hit,
    /// The kind of contact.
    pub contact: Contact,
}

/// All intersections, in one list for all rays.
#[derive(Debug, Default)]
pub struct Every {
    /// Intersections with their ray's index, in no particular order.
    pub met: Vec<(u32, Meeting)>,
    /// By ray: the factor from `t` to the given direction, and the maximum difference of `t` at a shared point.
    pub rays: Vec<(f64, f64)>,
}

impl Every {
    /// The entry of a ray that hits nothing.
    pub const UNTOLD: (f64, f64) = (1.0, 0.0);

    /// No intersections yet for the given number of rays.
    pub fn of(rays: usize) -> Self {
        Self { met: Vec::new(), rays: vec![Self::UNTOLD; rays] }
    }
}

impl Query for Every {
    type State = (u32, f64);
    const WANTED: Wanted = Wanted::Every;

    #[inline(always)]
    fn start(&self, i: usize, t_max: f64) -> (u32, f64) {
        (i as u32, t_max)
    }
    #[inline(always)]
    fn limit(state: &(u32, f64)) -> f64 {
        state.1
    }
    #[inline(always)]
    fn offer(&mut self, state: &mut (u32, f64), primitive: u32, candidate: Candidate) -> bool {
        let Candidate { t, uv, contact, inner } = candidate;
        self.met.push((state.0, Meeting { hit: Hit { t, uv, primitive, inner }, contact }));
        false
    }
    #[inline(always)]
    fn finish(&mut self, i: usize, answer: Option<(Along, (u32, f64))>) {
        if let Some((ray, _)) = answer {
            self.rays[i] = (ray.scale, ray.same_point());
        }
    }
}

/// The cost of the closest hit.
pub struct CostQuery<'a>(pub &'a mut [Cost]);

impl Query for CostQuery<'_> {
    type State = (Hit, Cost);
    const WANTED: Wanted = Wanted::Closest;
    const COUNTED: bool = true;

    #[inline(always)]
    fn start(&self, i: usize, t_max: f64) -> (Hit, Cost) {
        (ClosestQuery(&mut []).start(i, t_max), Cost::default())
    }
    #[inline(always)]
    fn limit(state: &(Hit, Cost)) -> f64 {
        state.0.t
    }
    #[inline(always)]
    fn offer(&mut self, state: &mut (Hit, Cost), primitive: u32, candidate: Candidate) -> bool {
        ClosestQuery(&mut []).offer(&mut state.0, primitive, candidate)
    }
    #[inline(always)]
    fn finish(&mut self, i: usize, answer: Option<(Along, (Hit, Cost))>) {
        self.0[i] = answer.map_or(Cost::default(), |(_, (_, cost))| cost);
    }
    #[inline(always)]
    fn visit_nodes(state: &mut (Hit, Cost), count: u32) {
        state.1.nodes += count;
    }
    #[inline(always)]
    fn visit_leaf(state: &mut (Hit, Cost), count: u32) {
        state.1.primitives += count;
    }
}

/// A structure that runs any query; each one is a [`super::Accelerator`].
pub trait Answers: Send + Sync + Sized + 'static {
    /// Run a query on every ray.
    fn answer<Q: Query>(&self, rays: &[Ray], query: &mut Q);

    /// See [`super::Accelerator::intersect`].
    fn intersect(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.answer(rays, &mut ClosestQuery(hits));
    }

    /// See [`super::Accelerator::occluded`].
    fn occluded(&self, rays: &[Ray], occluded: &mut [bool]) {
        self.answer(rays, &mut Any(occluded));
    }

    /// See [`super::Accelerator::by_columns`].
    fn by_columns(&self) -> Option<&dyn ByColumns> {
        None
    }

    /// See [`super::Accelerator::nearest_kept`].
    fn nearest(&self, points: &[DVec3], max_distances: &[f64], counts: PrimitiveFilter<'_>, nearest: &mut [Nearest]);

    /// See [`super::Accelerator::touched`].
    fn touched(&self, cones: &[Option<SolidCone>]) -> Touches;

    /// See [`super::Accelerator::boxes`].
    fn boxes(&self) -> Option<Boxes> {
        None
    }

    /// See [`super::Accelerator::refitted`].
    fn refitted(&self, primitives: &dyn Primitives) -> Result<Self, String>;

    /// See [`super::Accelerator::validate`].
    fn validate(&self, primitives: &dyn Primitives) -> Result<(), String>;

    /// See [`super::Accelerator::info`].
    fn info(&self) -> &Info;
}
