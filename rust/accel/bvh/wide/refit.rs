//! The same tree over triangles that have moved.

use super::node::{Child, WideNode};
use super::{WideBvh, aabb};
use crate::accel::{Info, Primitives};
use crate::math::Aabb;
use crate::shapes::triangle::Leaf;
use rayon::prelude::*;
use std::time::Instant;

impl<const N: usize, L: Leaf<N>> WideBvh<N, L> {
    /// The tree with the corners of `primitives` and boxes around them; which child stands where stays as it was. How much
    /// worse it has become its [`Info::sah_cost`] tells.
    pub(super) fn refit(&self, primitives: &dyn Primitives) -> Result<Self, String> {
        let start = Instant::now();
        if L::PRECISION == "single" && !primitives.is_single() {
            return Err("corners that are f64 do not fit leaves of f32".into());
        }
        let region = primitives.region();
        let triangles = |block: &L, count: u32| -> Result<Vec<_>, String> {
            let numbers = &block.lanes().primitives()[..count as usize];
            numbers
                .iter()
                .map(|&p| {
                    if (p as usize) < primitives.count() && primitives.is_finite(p) {
                        Ok((p, primitives.corners(p)))
                    } else {
                        Err(format!("primitive {p} could be hit, and cannot any more"))
                    }
                })
                .collect()
        };
        let finite = (0..primitives.count() as u32).into_par_iter().filter(|&p| primitives.is_finite(p)).count();
        if finite != self.info.primitives {
            return Err(format!("{finite} primitives can be hit, not {}", self.info.primitives));
        }
        let mut counts = vec![0; self.blocks.len()];
        for node in &self.nodes {
            for lane in 0..N {
                if let Child::Block { index, count } = node.child(lane) {
                    counts[index as usize] = count;
                }
            }
        }
        let blocks: Vec<L> = self
            .blocks
            .par_iter()
            .zip(&counts)
            .map(|(block, &count)| Ok(L::new(&region, triangles(block, count)?)))
            .collect::<Result<_, String>>()?;
        let mut nodes = self.nodes.clone();
        let mut around = vec![Aabb::EMPTY; nodes.len()];
        // Children come after their parents.
        for index in (0..nodes.len()).rev() {
            for lane in 0..N {
                let child = nodes[index].child(lane);
                let bounds = match child {
                    Child::None => continue,
                    Child::Node(below) => around[below as usize],
                    Child::Block { index, count } => blocks[index as usize].lanes().primitives()[..count as usize]
                        .iter()
                        .fold(Aabb::EMPTY, |b, &p| b.union(aabb(primitives, &region, p))),
                };
                nodes[index].set(lane, &bounds, child);
            }
            around[index] = nodes[index].bounds();
        }
        let mut bvh = Self { nodes, blocks, region, info: self.info.clone(), ..*self };
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

    /// The expected cost of a random ray that meets the root's box.
    pub(super) fn sah_cost(&self) -> f64 {
        let area = |b: &Aabb| f64::from(b.half_area().max(f32::MIN_POSITIVE));
        let Some(root) = self.nodes.first() else { return 0.0 };
        let (node_cost, leaf_cost) =
            (f64::from(self.options.traversal_cost), f64::from(self.options.intersection_cost));
        let below = |node: &WideNode<N>| -> f64 {
            (0..N)
                .map(|lane| match node.child(lane) {
                    Child::None => 0.0,
                    Child::Node(_) => node_cost * area(&node.aabb(lane)),
                    Child::Block { .. } => leaf_cost * area(&node.aabb(lane)),
                })
                .sum()
        };
        let root = area(&root.bounds());
        node_cost + self.nodes.iter().map(below).sum::<f64>() / root
    }
}
