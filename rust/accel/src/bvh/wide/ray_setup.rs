//! Setup of rays before traversal, sixteen at a time; rays that miss the tree are finished at once.

use super::WideBvh;
use super::leaf_visitor::Errand;
use super::node::Packed;
use super::sixteen::Sixteen;
use super::step::Boxes;
use crate::slab::SlabRay;
use raywright_base::math::{Aabb, RayBatch};
use raywright_base::simd::{Lanes, Simd};
use raywright_shapes::triangle::{ALL, Leaves, RAYS};

/// The rays of a batch that are not yet in flight.
pub struct Gate<'a> {
    rays: &'a RayBatch<'a>,
    /// The bounding box of the tree.
    bounds: Aabb,
    sixteen: Sixteen,
    /// The batch index of the first of the sixteen.
    start: usize,
    /// The first ray that has not been set up.
    next: usize,
    /// The rays among the sixteen that wait for their launch.
    waiting: u32,
}

impl<'a> Gate<'a> {
    /// All rays of a batch, for a nonempty tree.
    pub fn new<const N: usize, L>(bvh: &WideBvh<N, L>, rays: &'a RayBatch<'a>) -> Self {
        Self { rays, bounds: bvh.nodes[0].bounds(), sixteen: Sixteen::NONE, start: 0, next: 0, waiting: 0 }
    }

    /// Set up the next sixteen rays, of which there is at least one.
    #[inline(always)]
    fn look<const N: usize, L: Leaves<N>, S: Lanes<RAYS>, E: Errand<N, L>>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        errand: &mut E,
    ) {
        let count = RAYS.min(self.rays.len() - self.next);
        let here = ALL >> (RAYS - count);
        self.start = self.next;
        self.next += count;
        self.sixteen.take::<N, L, S>(simd, self.rays, self.start, &bvh.region, bvh.axes.as_ref());
        let Sixteen { plain, slabs, .. } = &self.sixteen;
        let mut passing = here & plain.plain & !slabs.meeting(simd, &self.bounds, simd.load(&slabs.limit));
        self.waiting = here & !passing;
        while passing != 0 {
            errand.miss(self.start + passing.trailing_zeros() as usize);
            passing &= passing - 1;
        }
    }

    /// Launch the next ray that may hit something; others are finished at once.
    #[inline(always)]
    pub fn launch<const N: usize, L: Leaves<N>, S: Simd<N>, E: Errand<N, L>>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        bottom: usize,
        errand: &mut E,
    ) -> Option<(Boxes, E::Flight)> {
        loop {
            while self.waiting == 0 {
                if self.next == self.rays.len() {
                    return None;
                }
                self.look(simd.sixteen(), bvh, errand);
            }
            let i = self.waiting.trailing_zeros() as usize & (RAYS - 1);
            self.waiting &= self.waiting - 1;
            let ray = self.start + i;
            if self.sixteen.plain.plain >> i & 1 == 1 {
                if let Some((flight, limit)) = errand.launch(bvh, ray, &self.sixteen, i) {
                    return Some((self.sixteen.boxes(i, limit, Packed::ROOT, bottom), flight));
                }
            } else if let Some((edges, slabs)) = SlabRay::prepare(bvh.axes.as_ref(), &self.rays.get(ray), &bvh.region) {
                let flight = errand.start(bvh, ray, &edges);
                let limit = slabs.limit(E::limit(bvh, &flight));
                return Some((Boxes::new(&slabs, limit, Packed::ROOT, bottom), flight));
            }
            errand.miss(ray);
        }
    }
}
