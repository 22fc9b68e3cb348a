//! The content of leaves: triangles in blocks, and other primitives by number.

use super::mailbox::Marks;
use super::{Few, Input, Lists};
use crate::query::Query;
use crate::{Primitives, UserGeometry};
use raywright_base::math::{DVec3, Ray, Region};
use raywright_base::simd::Simd;
use raywright_shapes::triangle::{BlockRay, EdgeRay, Leaves};
use std::sync::Arc;

/// A ray prepared for all kinds of primitives.
pub struct LeafRay<'a> {
    pub edges: &'a EdgeRay,
    pub lanes: BlockRay,
    pub time: f64,
}

/// The primitives of all leaves, with triangles in blocks of up to `N`.
pub struct Contents<const N: usize, L> {
    triangles: L,
    /// The start of each leaf's triangles, and the end of the last one's. Empty without triangles.
    ends: Vec<u32>,
    objects: Option<Arc<dyn UserGeometry>>,
    /// The numbers of objects by leaf, and the start of each leaf's. Empty without objects.
    numbers: Vec<u32>,
    number_ends: Vec<u32>,
}

impl<const N: usize, L: Leaves<N>> Contents<N, L> {
    /// Fill the leaves.
    pub fn new(input: &Input, lists: &Lists) -> Self {
        let primitives = input.primitives;
        let (mut order, mut blocks, mut ends) = (Vec::with_capacity(lists.order.len()), Vec::new(), vec![0]);
        let (mut numbers, mut number_ends) = (Vec::new(), vec![0]);
        let mut rest = lists.order.as_slice();
        for &count in &lists.counts {
            let (leaf, others) = rest.split_at(count as usize);
            rest = others;
            let before = order.len();
            for &p in leaf {
                // Primitives that cannot be hit are in no leaf.
                if primitives.objects().is_none() || primitives.is_finite(p) { order.push(p) } else { numbers.push(p) }
            }
            let triangles = order.len() - before;
            blocks.extend((0..triangles).step_by(N).map(|i| (triangles - i).min(N) as u32));
            ends.push(order.len() as u32);
            number_ends.push(numbers.len() as u32);
        }
        if numbers.is_empty() {
            number_ends = Vec::new();
        } else if order.is_empty() {
            ends = Vec::new();
        }
        ends.shrink_to_fit();
        number_ends.shrink_to_fit();
        numbers.shrink_to_fit();
        let triangles = L::new(&input.region, &order, &blocks, |p| primitives.corners(p));
        Self { triangles, ends, objects: primitives.objects(), numbers, number_ends }
    }

    /// All primitives, if they are few objects.
    pub fn few(&self) -> Option<Few> {
        let objects = self.objects.as_deref().filter(|_| self.ends.is_empty())?;
        Few::new(&self.numbers, objects)
    }

    /// Memory use in bytes.
    pub fn bytes(&self) -> usize {
        let words = self.ends.len() + self.numbers.len() + self.number_ends.len();
        self.triangles.bytes() + words * size_of::<u32>()
    }

    /// The range of a leaf's triangles.
    #[inline(always)]
    fn ends_of(&self, leaf: u32) -> (usize, usize) {
        match self.ends.get(leaf as usize..leaf as usize + 2) {
            Some(&[first, end]) => (first as usize, end as usize),
            _ => (0, 0),
        }
    }

    /// The triangle blocks of a leaf: start and count.
    #[inline(always)]
    fn blocks(&self, leaf: u32) -> impl Iterator<Item = (usize, u32)> + use<N, L> {
        let (first, end) = self.ends_of(leaf);
        (first..end).step_by(N).map(move |at| (at, (end - at).min(N) as u32))
    }

    #[inline(always)]
    fn numbers(&self, leaf: u32) -> &[u32] {
        match self.number_ends.get(leaf as usize..leaf as usize + 2) {
            Some(&[from, to]) => &self.numbers[from as usize..to as usize],
            _ => &[],
        }
    }

    /// The number of leaves.
    fn leaves(&self) -> u32 {
        self.ends.len().max(self.number_ends.len()) as u32 - 1
    }

    /// The primitives of a leaf.
    pub fn primitives(&self, leaf: u32) -> Vec<u32> {
        let triangles = self.blocks(leaf).flat_map(|(first, count)| self.triangles.primitives(first, count));
        triangles.chain(self.numbers(leaf).iter().copied()).collect()
    }

    /// The primitives of all leaves.
    pub fn lists(&self) -> Lists {
        let leaves: Vec<_> = (0..self.leaves()).map(|leaf| self.primitives(leaf)).collect();
        Lists::of(leaves.iter().map(Vec::as_slice))
    }

    /// The triangles of all leaves, with their numbers.
    pub fn triangles(&self) -> Vec<(u32, [DVec3; 3])> {
        let blocks = (0..self.leaves()).flat_map(|leaf| self.blocks(leaf));
        let of_block = |(first, count): (usize, u32)| {
            let corners = move |lane| self.triangles.corners(first, count, lane);
            self.triangles.primitives(first, count).enumerate().map(move |(lane, p)| (p, corners(lane)))
        };
        blocks.flat_map(of_block).collect()
    }

    /// Check that the triangles match the given corners.
    pub fn validate(&self, primitives: &dyn Primitives) -> Result<(), String> {
        match self.triangles().into_iter().find(|&(p, corners)| corners != primitives.corners(p)) {
            Some((p, _)) => Err(format!("primitive {p} has other corners in its leaf")),
            None => Ok(()),
        }
    }

    /// Prepare a ray for leaves.
    #[inline(always)]
    pub fn ray<'a>(&self, ray: &Ray, edges: &'a EdgeRay, region: &Region) -> LeafRay<'a> {
        LeafRay { edges, lanes: L::ray(edges, region), time: ray.time }
    }

    /// The lanes of a block whose primitives are new to the ray's mailbox.
    #[inline(always)]
    fn new_lanes(&self, first: usize, count: u32, marks: &mut Option<&mut Marks>) -> u32 {
        let is_new = |lane: usize| {
            let primitive = self.triangles.primitive(first, count, lane);
            marks.as_mut().is_none_or(|marks| marks.is_new(primitive))
        };
        (0..count as usize).map(is_new).enumerate().fold(0, |new, (lane, is_new)| new | u32::from(is_new) << lane)
    }

    /// Offer a leaf's intersections to the query. Return true if it is done.
    ///
    /// No primitive is decided or counted twice for a ray, as far as the mailbox remembers. The f32 test of a block may
    /// be repeated.
    #[inline(always)]
    pub fn meet<Q: Query, S: Simd<N>>(
        &self,
        simd: S,
        leaf: u32,
        ray: &LeafRay,
        marks: &mut Option<&mut Marks>,
        query: &mut Q,
        state: &mut Q::State,
    ) -> bool {
        let (mut first, end) = self.ends_of(leaf);
        while first < end {
            let count = (end - first).min(N) as u32;
            let mut left = self.triangles.not_rejected(simd, &ray.lanes, first, count);
            if Q::COUNTED {
                let new = self.new_lanes(first, count, marks);
                Q::visit_leaf(state, new.count_ones());
                left &= new;
            }
            while left != 0 {
                let lane = left.trailing_zeros() as usize & (N - 1);
                left &= left - 1;
                let primitive = self.triangles.primitive(first, count, lane);
                // Consult the mailbox only for lanes that pass the f32 test. Doing so for all lanes was slower than
                // repeating the test.
                if !Q::COUNTED
                    && let Some(marks) = marks
                    && !marks.is_new(primitive)
                {
                    continue;
                }
                if let Some(candidate) = ray.edges.meet_in(S::FUSED, self.triangles.corners(first, count, lane))
                    && query.offer(state, primitive, candidate)
                {
                    return true;
                }
            }
            first += N;
        }
        let numbers = self.numbers(leaf);
        !numbers.is_empty() && self.meet_objects(numbers, ray, marks, query, state)
    }

    /// The same for objects, given by number.
    pub fn meet_objects<Q: Query>(
        &self,
        numbers: &[u32],
        ray: &LeafRay,
        marks: &mut Option<&mut Marks>,
        query: &mut Q,
        state: &mut Q::State,
    ) -> bool {
        let Some(objects) = &self.objects else { return false };
        let EdgeRay { origin, direction, t_min, t_max, scale, .. } = *ray.edges;
        for &number in numbers {
            if marks.as_mut().is_some_and(|marks| !marks.is_new(number)) {
                continue;
            }
            Q::visit_leaf(state, 1);
            let t_max = t_max.min(Q::limit(state));
            let asked = Ray { t_min, t_max, time: ray.time, ..Ray::new(origin, direction) };
            let answered = objects.meet(number, query.wanted(), &asked, &mut |met| {
                // Reject hits whose `t` along a short direction overflows.
                (met.t * scale).is_finite() && query.offer(state, number, met)
            });
            if answered {
                return true;
            }
        }
        false
    }
}
