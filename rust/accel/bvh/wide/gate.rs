//! Rays on their way into a tree: made ready sixteen at a time, and those that pass it by answered at once.

use super::WideBvh;
use super::errand::Errand;
use super::node::Packed;
use super::step::Boxes;
use crate::accel::slab::{Clock, SlabRay, SlabRays};
use crate::math::{Aabb, RayBatch};
use crate::shapes::triangle::{ALL, EdgeRays, Leaves, RAYS};

/// Rays of a batch that have not been launched.
pub struct Gate<'a> {
    rays: &'a RayBatch<'a>,
    /// Around the tree.
    bounds: Aabb,
    edges: EdgeRays,
    slabs: SlabRays,
    /// The first of the sixteen.
    start: usize,
    /// The first that has not been looked at.
    next: usize,
    /// Of the sixteen, those that wait to be launched.
    waiting: u32,
    /// Of the sixteen, those that are plain ([`EdgeRays::prepare`]).
    plain: u32,
}

impl<'a> Gate<'a> {
    /// All rays of a batch; the tree is not empty.
    pub fn new<const N: usize, L>(bvh: &WideBvh<N, L>, rays: &'a RayBatch<'a>) -> Self {
        let (edges, slabs) = (EdgeRays::default(), SlabRays::default());
        Self { rays, bounds: bvh.nodes[0].bounds(), edges, slabs, start: 0, next: 0, waiting: 0, plain: 0 }
    }

    /// Looks at the next sixteen, of which there is at least one.
    #[inline(always)]
    fn look<const N: usize, L: Leaves<N>, E: Errand<N, L>>(&mut self, bvh: &WideBvh<N, L>, errand: &mut E) {
        let count = RAYS.min(self.rays.len() - self.next);
        let here = ALL >> (RAYS - count);
        self.start = self.next;
        self.next += count;
        self.edges.take(self.rays, self.start);
        self.plain = self.edges.prepare(&bvh.region);
        self.slabs.prepare(&self.edges, &bvh.region);
        let mut passing = here & self.plain & !self.slabs.meeting(&self.bounds);
        self.waiting = here & !passing;
        while passing != 0 {
            errand.miss(self.start + passing.trailing_zeros() as usize);
            passing &= passing - 1;
        }
    }

    /// The next ray that may hit something; the others are answered at once.
    #[inline(always)]
    pub fn launch<const N: usize, L: Leaves<N>, E: Errand<N, L>>(
        &mut self,
        bvh: &WideBvh<N, L>,
        bottom: usize,
        errand: &mut E,
    ) -> Option<(Boxes, E::Flight)> {
        loop {
            while self.waiting == 0 {
                if self.next == self.rays.len() {
                    return None;
                }
                self.look(bvh, errand);
            }
            let i = self.waiting.trailing_zeros() as usize & (RAYS - 1);
            self.waiting &= self.waiting - 1;
            let ray = self.start + i;
            if self.plain >> i & 1 == 1 {
                let flight = errand.start(bvh, ray, &self.edges.one(i));
                let limit = Clock::of(&bvh.region).limit(E::limit(&flight));
                return Some((Boxes::of(&self.slabs, i, limit, Packed::ROOT, bottom), flight));
            }
            if let Some((edges, slabs)) = SlabRay::prepare(&self.rays.get(ray), &bvh.region) {
                let flight = errand.start(bvh, ray, &edges);
                let limit = slabs.limit(E::limit(&flight));
                return Some((Boxes::new(&slabs, limit, Packed::ROOT, bottom), flight));
            }
            errand.miss(ray);
        }
    }
}
