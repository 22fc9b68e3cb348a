//! Refitting of a tree to moved triangles.

use super::node::{Child, WideNode};
use super::{WideBvh, aabb};
use crate::{Info, Primitives};
use raywright_base::math::Aabb;
use raywright_base::parallel::{self, CHUNK};
use raywright_base::work::Stopped;
use raywright_shapes::triangle::Leaves;
use std::ops::Range;
use std::time::Instant;

impl<const N: usize, L: Leaves<N>> WideBvh<N, L> {
    /// The tree with the corners of `primitives` and refitted boxes, and the same topology. [`Info::sah_cost`] shows
    /// how much worse it has become.
    pub(super) fn refit(&self, primitives: &dyn Primitives) -> Result<Self, String> {
        let start = Instant::now();
        if L::PRECISION == "single" && !primitives.is_single() {
            return Err("f64 corners cannot be stored in f32 leaves".into());
        }
        if self.in_parts {
            return Err("a tree with spatial splits cannot be refitted: rebuild it".into());
        }
        let region = primitives.region();
        let finite = |range: Range<usize>| range.filter(|&p| primitives.is_finite(p as u32)).count();
        let finite: usize = parallel::map_chunks(primitives.count(), CHUNK, finite).into_iter().sum();
        if finite != self.info.primitives {
            return Err(format!("{finite} primitives can be hit, expected {} as before", self.info.primitives));
        }
        // Leaf by leaf, in their order.
        let mut leaves: Vec<(usize, u32)> = Vec::with_capacity(self.info.leaves);
        for (_, child) in self.nodes.iter().flat_map(WideNode::children) {
            if let Child::Leaf { first, count } = child {
                leaves.push((first as usize, count));
            }
        }
        leaves.sort_unstable();
        let ended = |Stopped| "the refit was canceled".to_string();
        primitives.work().goes_on().map_err(ended)?;
        let numbers: Vec<u32> =
            leaves.iter().flat_map(|&(first, count)| self.leaves.primitives(first, count)).collect();
        if let Some(&p) = numbers.iter().find(|&&p| p as usize >= primitives.count() || !primitives.is_finite(p)) {
            return Err(format!("primitive {p} can no longer be hit"));
        }
        let counts: Vec<u32> = leaves.iter().map(|&(_, count)| count).collect();
        let new = L::new(&region, &numbers, &counts, |p| primitives.corners(p));
        let boxes = primitives
            .work()
            .collect(numbers.len(), |i| aabb(primitives, &region, self.axes.as_ref(), numbers[i]))
            .map_err(ended)?;
        let mut nodes = self.nodes.clone();
        let mut around = vec![Aabb::EMPTY; nodes.len()];
        // Children follow their parents.
        for index in (0..nodes.len()).rev() {
            let children: Vec<_> = nodes[index]
                .children()
                .map(|(_, child)| {
                    let bounds = match child {
                        Child::None => Aabb::EMPTY,
                        Child::Node(below) => around[below as usize],
                        Child::Leaf { first, count } => boxes[first as usize..(first + count) as usize]
                            .iter()
                            .fold(Aabb::EMPTY, |b, &other| b.union(other)),
                    };
                    (bounds, child)
                })
                .collect();
            nodes[index] = WideNode::new(&children);
            around[index] = nodes[index].bounds();
        }
        let mut bvh = Self { nodes, leaves: new, region, info: self.info.clone(), ..*self };
        bvh.arrange();
        bvh.info = Info {
            kind: if self.info.kind.ends_with(", refitted") {
                self.info.kind.clone()
            } else {
                format!("{}, refitted", self.info.kind)
            },
            build_seconds: start.elapsed().as_secs_f64(),
            sah_cost: bvh.sah_cost(),
            ..bvh.info
        };
        Ok(bvh)
    }

    /// The expected cost of a random ray that hits the root's box.
    pub(super) fn sah_cost(&self) -> f64 {
        let area = |b: &Aabb| f64::from(b.half_area().max(f32::MIN_POSITIVE));
        let Some(root) = self.nodes.first() else { return 0.0 };
        let (node_cost, leaf_cost) =
            (f64::from(self.options.traversal_cost), f64::from(self.options.intersection_cost));
        let below = |(bounds, child): (Aabb, Child)| match child {
            Child::None => 0.0,
            Child::Node(_) => node_cost * area(&bounds),
            Child::Leaf { .. } => leaf_cost * area(&bounds),
        };
        let root = area(&root.bounds());
        node_cost + self.nodes.iter().flat_map(WideNode::children).map(below).sum::<f64>() / root
    }
}
