//! What rays are sent for: each kernel is compiled for each errand.

use super::WideBvh;
use super::node::{Packed, WideNode};
use super::sixteen::Sixteen;
use super::step::{Boxes, Stacks};
use crate::query::Query;
use crate::slab::Clock;
use raywright_base::math::RayBatch;
use raywright_base::simd::Simd;
use raywright_shapes::triangle::{BlockRay, EdgeRay, Leaves};

/// What came of a ray's visit to a leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Visited {
    /// Nothing that changes its way.
    Nothing,
    /// From now on it need not go beyond this `t` along its scaled direction.
    Until(f64),
    /// All that was asked.
    Answered,
}

/// What is done with rays at leaves.
pub trait Errand<const N: usize, L: Leaves<N>>: Sized {
    /// What is known of a ray, and what it needs at leaves.
    type Flight;

    /// Whether the nearest triangles should be looked at first.
    const NEAREST_FIRST: bool;

    /// Whether [`Visited::Until`] is ever said.
    const SHORTENS: bool;

    /// What is known at first of ray `i` of the batch.
    fn start(&mut self, bvh: &WideBvh<N, L>, i: usize, edges: &EdgeRay) -> Self::Flight;

    /// Up to which `t` along its scaled direction a ray is asked, at first.
    fn limit(bvh: &WideBvh<N, L>, flight: &Self::Flight) -> f64;

    /// What is known at first of a plain ray, one of sixteen, and where in box units it loses interest; nothing if it
    /// hits nothing.
    fn launch(&mut self, bvh: &WideBvh<N, L>, i: usize, rays: &Sixteen, lane: usize) -> Option<(Self::Flight, f32)>;

    /// A ray has tested a node's boxes.
    #[inline(always)]
    fn visit_node(_: &mut Self::Flight) {}

    /// A ray is at a leaf.
    fn visit<S: Simd<N>>(&mut self, simd: S, bvh: &WideBvh<N, L>, flight: &mut Self::Flight, at: Packed) -> Visited;

    /// A ray has seen all that it has to.
    fn finish<S: Simd<N>>(&mut self, simd: S, bvh: &WideBvh<N, L>, flight: &Self::Flight);

    /// Ray `i` hits nothing.
    fn miss(&mut self, i: usize);

    /// All rays have.
    #[inline(always)]
    fn end<S: Simd<N>>(&mut self, _: S, _: &WideBvh<N, L>) {}
}

/// A ray tests the children of a node, in the order that suits its errand.
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

/// Tells a query all that rays meet.
pub struct Telling<'a, Q> {
    pub rays: &'a RayBatch<'a>,
    pub query: &'a mut Q,
}

/// A ray whose meetings are told.
pub struct Told<T> {
    lanes: BlockRay,
    edges: EdgeRay,
    state: T,
    ray: usize,
}

impl<const N: usize, L: Leaves<N>, Q: Query> Errand<N, L> for Telling<'_, Q> {
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
