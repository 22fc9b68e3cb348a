//! Queries with a hit filter: the caller decides for each intersection whether it counts.

use super::query::{ClosestQuery, Query, Wanted};
use raywright_base::math::Hit;
use raywright_shapes::Candidate;
use raywright_shapes::triangle::Along;

/// True if ray `i` of a batch accepts a primitive's intersection; `t` is along the scaled direction.
pub type Counts<'a> = dyn Fn(usize, u32, &Candidate) -> bool + Sync + 'a;

/// The closest accepted hit, or any accepted one.
///
/// Rejected intersections have no effect: they neither shorten a ray nor end it.
pub struct Kept<'a> {
    /// The filter.
    pub counts: &'a Counts<'a>,
    /// True if any accepted hit will do.
    pub any: bool,
    /// The hit of each ray.
    pub hits: &'a mut [Hit],
}

impl Query for Kept<'_> {
    type State = (usize, Hit);
    // Of a curved shape or an instance, the first intersection may be rejected and a later one accepted.
    const WANTED: Wanted = Wanted::Met;
    const NEAREST_FIRST: bool = true;

    #[inline(always)]
    fn start(&self, i: usize, t_max: f64) -> (usize, Hit) {
        (i, ClosestQuery(&mut []).start(i, t_max))
    }
    #[inline(always)]
    fn limit(state: &(usize, Hit)) -> f64 {
        state.1.t
    }
    #[inline(always)]
    fn offer(&mut self, (ray, best): &mut (usize, Hit), primitive: u32, candidate: Candidate) -> bool {
        if !(self.counts)(*ray, primitive, &candidate) {
            return false;
        }
        ClosestQuery(&mut []).offer(best, primitive, candidate);
        self.any
    }
    #[inline(always)]
    fn finish(&mut self, i: usize, answer: Option<(Along, (usize, Hit))>) {
        ClosestQuery(self.hits).finish(i, answer.map(|(ray, (_, hit))| (ray, hit)));
    }
}
