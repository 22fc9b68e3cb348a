//! The closest hit among what counts for a ray: whoever asks says so of each thing that the ray meets.

use super::query::{Closest, Query, Wanted};
use raywright_base::math::Hit;
use raywright_shapes::Candidate;
use raywright_shapes::triangle::Along;

/// Whether a primitive counts for ray `i` of a batch, which meets it so; `t` is along the scaled direction.
pub type Counts<'a> = dyn Fn(usize, u32, &Candidate) -> bool + Sync + 'a;

/// The closest hit that counts or, if any will do, one that does.
///
/// All goes as it would if what does not count were not there: it neither shortens a ray nor ends it.
pub struct Kept<'a> {
    /// What counts.
    pub counts: &'a Counts<'a>,
    /// Whether any hit will do.
    pub any: bool,
    /// Of each ray.
    pub hits: &'a mut [Hit],
}

impl Query for Kept<'_> {
    type State = (usize, Hit);
    // Of a curved shape or a copy, the first point may not count and the next one may.
    const WANTED: Wanted = Wanted::Met;
    const NEAREST_FIRST: bool = true;

    #[inline(always)]
    fn start(&self, i: usize, t_max: f64) -> (usize, Hit) {
        (i, Closest(&mut []).start(i, t_max))
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
        Closest(&mut []).offer(best, primitive, candidate);
        self.any
    }
    #[inline(always)]
    fn finish(&mut self, i: usize, answer: Option<(Along, (usize, Hit))>) {
        Closest(self.hits).finish(i, answer.map(|(ray, (_, hit))| (ray, hit)));
    }
}
