//! Rare queries as one type: dispatch at each hit, so that traversal is compiled once for all.

use super::filtered_query::Kept;
use super::query::{Every, Query, Wanted};
use raywright_base::math::Hit;
use raywright_shapes::Candidate;
use raywright_shapes::triangle::Along;

/// One of the rare queries.
pub enum RareQuery<'a> {
    Kept(Kept<'a>),
    Every(&'a mut Every),
}

/// The state of a ray in any of them.
#[derive(Clone, Copy, Debug)]
pub struct State {
    limit: f64,
    ray: u32,
    hit: Hit,
}

impl RareQuery<'_> {
    // Not inlined: a kernel calls these for few of its triangles, and need not contain their code.
    #[inline(never)]
    fn initial_state(&self, i: usize, t_max: f64) -> State {
        match self {
            Self::Kept(kept) => {
                let (_, hit) = kept.start(i, t_max);
                State { limit: hit.t, ray: i as u32, hit }
            }
            Self::Every(_) => State { limit: t_max, ray: i as u32, hit: Hit::MISS },
        }
    }

    #[inline(never)]
    fn offer_hit(&mut self, state: &mut State, primitive: u32, candidate: Candidate) -> bool {
        match self {
            Self::Kept(kept) => {
                let mut known = (state.ray as usize, state.hit);
                let is_answered = kept.offer(&mut known, primitive, candidate);
                state.hit = known.1;
                state.limit = state.hit.t;
                is_answered
            }
            Self::Every(every) => every.offer(&mut (state.ray, state.limit), primitive, candidate),
        }
    }

    #[inline(never)]
    fn write_answer(&mut self, i: usize, answer: Option<(Along, State)>) {
        match self {
            Self::Kept(kept) => kept.finish(i, answer.map(|(ray, state)| (ray, (i, state.hit)))),
            Self::Every(every) => every.finish(i, answer.map(|(ray, state)| (ray, (state.ray, state.limit)))),
        }
    }
}

impl Query for RareQuery<'_> {
    type State = State;
    const WANTED: Wanted = Wanted::Met;
    const NEAREST_FIRST: bool = true;

    #[inline(always)]
    fn wanted(&self) -> Wanted {
        match self {
            Self::Kept(_) => Kept::WANTED,
            Self::Every(_) => Every::WANTED,
        }
    }
    #[inline(always)]
    fn start(&self, i: usize, t_max: f64) -> State {
        self.initial_state(i, t_max)
    }
    #[inline(always)]
    fn limit(state: &State) -> f64 {
        state.limit
    }
    #[inline(always)]
    fn offer(&mut self, state: &mut State, primitive: u32, candidate: Candidate) -> bool {
        self.offer_hit(state, primitive, candidate)
    }
    #[inline(always)]
    fn finish(&mut self, i: usize, answer: Option<(Along, State)>) {
        self.write_answer(i, answer);
    }
}
