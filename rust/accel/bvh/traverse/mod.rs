//! Ways through the binary tree, as textbooks have them.

mod moving;
mod ordered;

pub use moving::Moving;
pub use ordered::Ordered;

use super::BinaryBvh;
use crate::accel::walk::Lists;
use crate::math::Aabb;

/// Where each leaf's node is, and what stands in it: leaves are numbered as their nodes are.
fn leaves(bvh: &BinaryBvh) -> (Vec<u32>, Lists) {
    let nodes = bvh.nodes.iter().enumerate().filter(|(_, node)| node.is_leaf());
    let numbers: Vec<u32> = nodes.clone().map(|(i, _)| i as u32).collect();
    let primitives = nodes.map(|(_, n)| &bvh.order[n.index as usize..(n.index + n.count) as usize]);
    (numbers, Lists::of(primitives))
}

/// The surface-area heuristic's cost of a tree, in tests of a node: of every inner node its two boxes, of every leaf its primitives, each
/// times the chance that a ray that meets the root's box meets this one's.
fn sah_cost(bvh: &BinaryBvh) -> f64 {
    let area = |aabb: &Aabb| f64::from(aabb.half_area());
    let sum: f64 = bvh.nodes.iter().map(|n| area(&n.aabb()) * if n.is_leaf() { f64::from(n.count) } else { 2.0 }).sum();
    match area(&bvh.bounds()) {
        root if root > 0.0 => sum / root,
        _ => bvh.nodes.len() as f64,
    }
}
