//! Visitors of leaves: traversal kernels are generic over the visitor.

use super::WideBvh;
use super::node::{Packed, WideNode};
use super::sixteen::Sixteen;
use super::step::{Boxes, Stacks};
use crate::query::Query;
use crate::slab::Clock;
use raywright_base::math::RayBatch;
use raywright_base::simd::Simd;
use raywright_shapes::triangle::{BlockRay, EdgeRay, Leaves};

/// The effect of a ray's visit to a leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Visited {
    /// No change.
    Nothing,
    /// The ray now ends at this `t` along its scaled direction.
    Until(f64),
    /// The query is done.
    Answered,
}

/// A visitor that processes rays at leaves.
pub trait Errand<const N: usize, L: Leaves<N>>: Sized {
    /// The state of a ray, with the data for its leaf tests.
    type Flight;

    /// True if traversal should go nearest first.
    const NEAREST_FIRST: bool;

    /// True if [`Visited::Until`] is ever returned.
    const SHORTENS: bool;

    /// The initial state of ray `i` of the batch.
    fn start(&mut self, bvh: &WideBvh<N, L>, i: usize, edges: &EdgeRay) -> Self::Flight;

    /// The initial end of a ray along its scaled direction.
    fn limit(bvh: &WideBvh<N, L>, flight: &Self::Flight) -> f64;

    /// The initial state of a plain ray, given by its lane of sixteen, and its end in box units; None if it cannot hit
    /// anything.
    fn launch(&mut self, bvh: &WideBvh<N, L>, i: usize, rays: &Sixteen, lane: usize) -> Option<(Self::Flight, f32)>;

    /// Count a visited node.
    #[inline(always)]
    fn visit_node(_: &mut Self::Flight) {}

    /// Process a ray at a leaf.
    fn visit<S: Simd<N>>(&mut self, simd: S, bvh: &WideBvh<N, L>, flight: &mut Self::Flight, at: Packed) -> Visited;

    /// Finish a ray after its traversal.
    fn finish<S: Simd<N>>(&mut self, simd: S, bvh: &WideBvh<N, L>, flight: &Self::Flight);

    /// Report a miss of ray `i`.
    fn miss(&mut self, i: usize);

    /// Finish the batch after all rays.
    #[inline(always)]
    fn end<S: Simd<N>>(&mut self, _: S, _: &WideBvh<N, L>) {}
}

/// Test the children of a node with a ray, in the visitor's order.
#[inline(always)]
pub fn enter<const N: usize, L: Leaves<N>, S: Simd<N>, E: Errand<N, L>>(
    simd: S,
    ray: &mut Boxes,
    node: &WideNode<N>,
    stacks: &mut Stacks,
) {
    match (E::NEAREST_FIRST, E::SHORTENS) {
        (true, _) => ray.enter::<N, S, true, true>(simd, node, stacks),
        (false, true) => ray.enter::<N, S, false, true>(simd, node, stacks),
        (false, false) => ray.enter::<N, S, false, false>(simd, node, stacks),
    }
}

/// Offers all intersections to a query.
pub struct QueryVisitor<'a, Q> {
    pub rays: &'a RayBatch<'a>,
    pub query: &'a mut Q,
}

/// The state of a ray for a query.
pub struct Told<T> {
    lanes: BlockRay,
    edges: EdgeRay,
    state: T,
    ray: usize,
}

impl<const N: usize, L: Leaves<N>, Q: Query> Errand<N, L> for QueryVisitor<'_, Q> {
    type Flight = Told<Q::State>;
    const NEAREST_FIRST: bool = Q::NEAREST_FIRST;
    const SHORTENS: bool = true;

    #[inline(always)]
    fn start(&mut self, bvh: &WideBvh<N, L>, i: usize, edges: &EdgeRay) -> Told<Q::State> {
        let state = self.query.start(i, edges.t_max);
        Told { lanes: L::ray(edges, &bvh.region), edges: *edges, state, ray: i }
    }

    #[inline(always)]
    fn limit(_: &WideBvh<N, L>, flight: &Told<Q::State>) -> f64 {
        Q::limit(&flight.state)
    }

    #[inline(always)]
    fn launch(&mut self, bvh: &WideBvh<N, L>, i: usize, _: &Sixteen, _: usize) -> Option<(Told<Q::State>, f32)> {
        let flight = self.start(bvh, i, &EdgeRay::new(&self.rays.get(i), &bvh.region)?);
        let limit = Clock::of(&bvh.region).limit(Q::limit(&flight.state));
        Some((flight, limit))
    }

    #[inline(always)]
    fn visit_node(flight: &mut Told<Q::State>) {
        Q::visit_node(&mut flight.state);
    }

    #[inline(always)]
    fn visit<S: Simd<N>>(&mut self, simd: S, bvh: &WideBvh<N, L>, flight: &mut Told<Q::State>, at: Packed) -> Visited {
        let (first, count) = at.leaf();
        let Told { lanes, edges, state, .. } = flight;
        Q::visit_leaf(state, count);
        let before = Q::limit(state);
        let mut left = bvh.leaves.not_rejected(simd, lanes, first, count);
        while left != 0 {
            let lane = left.trailing_zeros() as usize & (N - 1);
            left &= left - 1;
            if let Some(candidate) = edges.meet_in(S::FUSED, bvh.leaves.corners(first, count, lane))
                && self.query.offer(state, bvh.leaves.primitive(first, count, lane), candidate)
            {
                return Visited::Answered;
            }
        }
        let limit = Q::limit(state);
        if limit < before { Visited::Until(limit) } else { Visited::Nothing }
    }

    #[inline(always)]
    fn finish<S: Simd<N>>(&mut self, _: S, _: &WideBvh<N, L>, flight: &Told<Q::State>) {
        self.query.finish(flight.ray, Some((flight.edges.along(), flight.state)));
    }

    #[inline(always)]
    fn miss(&mut self, i: usize) {
        self.query.finish(i, None);
    }
}
