//! Point-in-solid tests by ray parity: from inside, a ray crosses a closed surface an odd number of times.
//!
//! All decisions are exact. [`Contact`] tells which triangles the ray crosses, also through edges and corners. `t` is
//! the f64 nearest to the exact one, so it is 0 only on a surface.

use super::query::{Query, Wanted};
use raywright_shapes::triangle::Along;
use raywright_shapes::{Candidate, Contact};

/// The side of a surface on which a point lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// The ray crosses the surface an even number of times.
    #[default]
    Outside,
    /// The ray crosses the surface an odd number of times.
    Inside,
    /// The point is on the surface.
    Surface,
}

/// A crossing of a ray with a surface ahead of its origin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Exit {
    /// The index of the ray.
    pub ray: u32,
    /// The primitive.
    pub primitive: u32,
    /// The primitive within an instance.
    pub inner: u32,
    /// The bits of `t`, which distinguish crossings of one primitive.
    t: u64,
}

/// All crossings of rays ahead of their origins, each once, by ray and primitive; and the origins on a surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Exits {
    /// The crossings.
    pub crossed: Vec<Exit>,
    /// True if the origin of each ray is a point of a surface.
    pub on_surface: Vec<bool>,
}

impl Exits {
    /// The side of all surfaces together on which each origin lies, by the even-odd rule.
    pub fn sides(&self) -> Vec<Side> {
        let mut sides = vec![Side::Outside; self.on_surface.len()];
        for exits in self.crossed.chunk_by(|a, b| a.ray == b.ray) {
            sides[exits[0].ray as usize] = if exits.len() % 2 == 1 { Side::Inside } else { Side::Outside };
        }
        for (side, on_surface) in sides.iter_mut().zip(&self.on_surface) {
            *side = if *on_surface { Side::Surface } else { *side };
        }
        sides
    }

    /// Merge the results of two structures.
    pub(crate) fn joined(mut self, other: Self) -> Self {
        self.crossed.extend(other.crossed);
        for (on_surface, other) in self.on_surface.iter_mut().zip(other.on_surface) {
            *on_surface |= other;
        }
        self.in_order()
    }

    /// Sort by ray and primitive, without duplicates: a structure may report a crossing more than once.
    pub(crate) fn in_order(mut self) -> Self {
        self.crossed.sort_unstable();
        self.crossed.dedup();
        self
    }
}

/// A query for the surfaces that rays cross ahead of their origins.
pub struct WaysOut<'a> {
    /// True if a primitive counts.
    pub counts: &'a (dyn Fn(u32) -> bool + Sync),
    /// The results, in any order.
    pub exits: Exits,
}

impl Query for WaysOut<'_> {
    type State = (u32, bool);
    const WANTED: Wanted = Wanted::Side;

    #[inline(always)]
    fn start(&self, i: usize, _: f64) -> (u32, bool) {
        (i as u32, false)
    }
    #[inline(always)]
    fn limit(_: &(u32, bool)) -> f64 {
        f64::INFINITY
    }
    #[inline(always)]
    fn offer(&mut self, (ray, on_surface): &mut (u32, bool), primitive: u32, met: Candidate) -> bool {
        if !(self.counts)(primitive) {
            return false;
        }
        let Candidate { t, contact, inner, .. } = met;
        if t == 0.0 {
            *on_surface = true;
        } else if contact != Contact::Touching {
            self.exits.crossed.push(Exit { ray: *ray, primitive, inner, t: t.to_bits() });
        }
        *on_surface
    }
    #[inline(always)]
    fn finish(&mut self, i: usize, answer: Option<(Along, (u32, bool))>) {
        self.exits.on_surface[i] = answer.is_some_and(|(_, (_, on_surface))| on_surface);
    }
}
